# shellcheck shell=dash
# The conformance suite on the kernel's own virtual board, a test with two channels, then a hundred starts and stops
# of the daemon.
. /lib.sh
modprobe comedi_test period=50000 amplitude=1000000
STICKSLIP_COMEDI_DEVICE=/dev/comedi0 STICKSLIP_COMEDI_SECOND=1 conformance_board --gtest_filter='*OnTheKernel*' >/results/conformance.txt ||
  fail "conformance: $(cat /results/conformance.txt)"
say "conforms"

# Channel 1 of comedi_test is a square wave in step with the saw-tooth of channel 0.
use second
chosen='speed_channel = 1
speed_gain = "1 mm/s/V"'
load_cell_zero="-5 V" configure
chosen=''
start_daemon
await current_test '[0-9]'
sleep 3
stop_daemon
say "two channels"

use cycles
# A trigger that the saw-tooth does not reach: no tests, no records.
configure '[test]' 'start = 5'
touch "$folder/daemon.log"
for cycle in $(seq 100); do
  start_daemon
  # The line that it logs at the first scan: asking for the status would double the time of this.
  until [ "$(grep -c 'Hz granted' "$folder/daemon.log")" = "$cycle" ]; do
    kill -0 "$(daemon)" || fail "the daemon ended by itself"
    sleep 0.1
  done
  stop_daemon
  [ ! -e "$socket" ] || fail "the control socket outlived the daemon"
  echo "$cycle" >/results/cycles-done
done
say "a hundred starts and stops"

# shellcheck shell=dash
# Codes of simulated tests through the virtual tester, and the same scenes on the simulated board.
. /lib.sh
modprobe stickslip_tester restart=1
STICKSLIP_COMEDI_DEVICE=/dev/comedi0 STICKSLIP_COMEDI_REPEATS=1 conformance_board --gtest_filter='*OnTheKernel*' \
  >/results/conformance.txt || fail "conformance: $(cat /results/conformance.txt)"
say "conforms"
rmmod stickslip_tester

modprobe stickslip_tester
use kernel
configure
start_daemon
await current_test '[0-9]'
# Looking at a board that is at work disturbs nobody.
stickslip boards --json >/results/boards.json
stickslip boards >/results/boards.txt
await test_count "$(wc -l </scenes/list)" 120
status played
stop_daemon
rmmod stickslip_tester
say "played"

stickslipd --config /scenes/reference.toml 2>/results/simulated.log
say "simulated"

# A board whose clock is fast.
modprobe stickslip_tester rate_error_ppb="$(cat /scenes/rate_error_ppb)"
use rate-error
configure
start_daemon
await test_count 1 120
status played
stop_daemon

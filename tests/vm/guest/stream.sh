# shellcheck shell=dash
# Ten minutes at the kernel's own virtual board: one test without end, saw-tooth of 20 Hz, 8 to 12 N.
. /lib.sh
modprobe comedi_test period=50000 amplitude=1000000
use stream
# Scans are what is proven here. To fit the model to 12000 slips takes the translated processor minutes, and that it
# gives the same bits as elsewhere is what tester.sh shows.
load_cell_zero="-5 V" configure '[analysis]' 'estimator = "turning-points"'
start_daemon
await state '"acquiring"'
say "acquiring"
sleep 600
status ten-minutes
# Inside its test: 12000 cycles are evaluated, and the record is built.
stop_daemon
say "over"

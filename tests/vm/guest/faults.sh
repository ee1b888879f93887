# shellcheck shell=dash
# What goes wrong at a bench. Each scenario has a board that begins with the first code, and a daemon of its own.
. /lib.sh
switches=/sys/module/stickslip_tester/parameters

# board: a fresh one.
board() {
  [ ! -d "$switches" ] || rmmod stickslip_tester
  modprobe stickslip_tester
}

# A test runs: the pull has begun and goes on for seconds.
start_test() {
  use "$1"
  configure
  start_daemon
  await current_test '[0-9]'
  sleep 2
}

board
start_test overrun
cat /faults/overrun_scans >"$switches/overrun"
await overrun_count 1
await test_count 1
status after
stop_daemon
say "overrun: done"

board
start_test removal
echo 0 >"$switches/attached"
await state '"board missing"'
status gone
sleep 3
echo 1 >"$switches/attached"
await state '"acquiring"'
status returned
# The interrupted one, the rest of its pull and a whole one.
await test_count 3 120
status after
stop_daemon
say "removal: done"

# Pulled and plugged in again, while the kernel's test board takes its device file: it comes back under another one.
# The daemon that knows it by its serial number follows it; the one that has only the path says who is there.
board
chosen='serial = "01A2B3C4"'
start_test renamed
echo 0 >"$switches/attached"
await state '"board missing"'
modprobe comedi_test
await detail '"board missing: no board with serial'
status gone
echo 1 >"$switches/attached"
await state '"acquiring"'
status returned
await test_count 2 120
status after
stop_daemon
chosen=''
rmmod comedi_test
say "renamed: done"

board
start_test taken
echo 0 >"$switches/attached"
await state '"board missing"'
modprobe comedi_test
await detail '"board missing: /dev/comedi0: another board'
stickslip doctor --json --config "/run/taken/stickslipd.toml" >"$folder/doctor.json" || true
echo 1 >"$switches/attached"
await detail '"board missing: /dev/comedi0: another board.*there is /dev/comedi1: stickslip_tester'
status gone
stickslip boards --json >"$folder/boards.json"
echo 0 >"$switches/attached"
rmmod comedi_test
echo 1 >"$switches/attached"
await state '"acquiring"'
status returned
stop_daemon
say "taken: done"

# A rival was there first: the daemon waits for it to go.
board
use rival
configure
start_daemon
await state '"acquiring"'
use second
configure
start_daemon
await state '"board busy"'
status waiting
use rival
stop_daemon
use second
await state '"acquiring"'
await current_test '[0-9]'
# A rival that comes later gets nothing and harms nothing.
use rival
start_daemon
await state '"board busy"'
status refused
stop_daemon
use second
await test_count 1
status after
stop_daemon
say "rival: done"

# A board that the daemon's user may not open.
as_user() { exec su -s /bin/sh stickslip -c "exec $*"; }
board
chmod 0600 /dev/comedi0
use permission
configure
chown -R 1000:1000 "$folder" "/run/$name"
start_daemon as_user
await state '"no permission"'
status no-group
# As udev leaves it.
chgrp iocard /dev/comedi0
chmod 0660 /dev/comedi0
await detail '"no permission.* it is for group iocard'
status refused
# As adding the user to the group does.
chgrp stickslip /dev/comedi0
await state '"acquiring"'
await test_count 1
status after
stop_daemon
say "permission: done"

board
start_test stopped
stop_daemon
say "stopped: done"

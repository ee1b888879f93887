# shellcheck shell=dash
# The package in a whole Debian: installed without a board, at work with the kernel's own test board and with ours,
# a board that goes and returns, removal and purge.
set -eu
. ./unit.sh
switches=/sys/module/stickslip_tester/parameters

dpkg -i stickslip.deb >"$results/dpkg.txt" 2>&1 || fail "dpkg -i: $(cat "$results/dpkg.txt")"
say "installed"
systemctl is-enabled "$unit"
await state '"board missing"' installed
systemctl is-active "$unit"
# Without a board it waits; a reload has it read its configuration again, in the same process.
pid=$(property MainPID)
systemctl reload "$unit"
left=60
until journalctl --no-pager -u "$unit" | grep -q 'reload: the configuration is good'; do
  left=$((left - 1))
  [ "$left" -gt 0 ] || fail "no reload"
  sleep 1
done
await state '"board missing"' reloaded
[ "$(property MainPID)" = "$pid" ] || fail "a reload started another process"
say "reloaded"
mkdir -m 777 /run/demo
(cd /run/demo && setpriv --reuid=nobody --regid=nogroup --clear-groups stickslip demo) >"$results/demo.txt" 2>&1 ||
  fail "stickslip demo: $(cat "$results/demo.txt")"
say "demo ran"

modprobe comedi_test
await state '"acquiring"' test-board
systemctl stop "$unit"
rmmod comedi_test
say "board of the kernel"

sed -i 's|^load_cell_gain = .*|load_cell_gain = "2 N/V"|' "$config"
install -D -m 0644 codes.bin /lib/firmware/stickslip-codes.bin
insmod ./stickslip_tester.ko
udevadm settle
stat -c '%a %U %G' /dev/comedi0 >"$results/device"
readlink -f /dev/comedi/by-path/platform-stickslip_tester >"$results/link" || true
systemctl start "$unit"
say "started"
await state '"acquiring"' started
await current_test '[0-9]' testing
pid=$(property MainPID)
cp "/proc/$pid/status" "$results/process"
getent group iocard | cut -d: -f3 >"$results/iocard"
id -u stickslip >"$results/user"
systemd-analyze --no-pager security "$unit" >"$results/security.txt" || true
say "at work"

echo 0 >"$switches/attached"
await state '"board missing"' gone
systemctl is-active "$unit"
property StatusText >"$results/text-gone"
say "board gone"
echo 1 >"$switches/attached"
await state '"acquiring"' returned
property StatusText >"$results/text-returned"
[ "$(property MainPID)" = "$pid" ] || fail "the daemon was started again"
say "board back"

began=$(cut -d. -f1 /proc/uptime)
systemctl stop "$unit"
echo $(($(cut -d. -f1 /proc/uptime) - began)) >"$results/stop-seconds"
for name in ActiveState Result ExecMainStatus NRestarts; do
  echo "$name=$(property $name)"
done >"$results/end"
[ ! -e "$socket" ] || fail "the control socket outlived the daemon"
journalctl --sync
journalctl --no-pager -u "$unit" -o json >"$results/journal.json"
journalctl --no-pager STICKSLIP_EVENT=gap -o json >"$results/gaps.json"
data=/var/lib/stickslip/records
find "$data" -name '*.h5' -exec stat -c '%a %U %G %n' {} + >"$results/files"
mkdir "$results/records"
find "$data" -name '*.h5' -exec cp {} "$results/records" ';'
say "stopped"

# What hangs is started again. A shorter watchdog than as shipped: a disk may take four of its intervals.
mkdir -p "/run/systemd/system/$unit.d"
printf '[Service]\nWatchdogSec=8\n' >"/run/systemd/system/$unit.d/watchdog.conf"
systemctl daemon-reload
systemctl start "$unit"
for thread in acquisition processing disk stickslipd; do
  await state '"acquiring"' "before-$thread"
  restarts=$(property NRestarts)
  mkfifo "/run/hold-$thread"
  ./freeze_thread "$(property MainPID)" "$thread" <"/run/hold-$thread" &
  exec 9>"/run/hold-$thread"
  left=120
  until [ "$(property NRestarts)" -gt "$restarts" ]; do
    left=$((left - 1))
    [ "$left" -gt 0 ] || fail "a frozen $thread is not noticed"
    sleep 1
  done
  exec 9>&-
  await state '"acquiring"' "after-$thread"
  say "$thread froze: started again"
done
journalctl --no-pager -u "$unit" >"$results/watchdog.txt"
rm -r "/run/systemd/system/$unit.d"
systemctl daemon-reload
systemctl stop "$unit"

# The socket of the service manager: who asks starts the daemon, and is answered.
systemctl start stickslipd.socket
! systemctl is-active --quiet "$unit" || fail "the daemon runs before anybody asks"
stickslip status --json --socket "$socket" >"$results/activated.json" || fail "no answer by the socket"
systemctl is-active "$unit"
systemctl stop stickslipd.socket "$unit"
say "socket"

systemctl start "$unit"
await state '"acquiring"' started-again
kept() { find "$data" -name '*.h5' -exec sha256sum {} + | sort | grep -F -f "$results/sums" | sha256sum; }
find "$data" -name '*.h5' -exec sha256sum {} + | sort >"$results/sums"
before=$(kept)
dpkg -r stickslip >>"$results/dpkg.txt" 2>&1 || fail "dpkg -r"
! systemctl is-active --quiet "$unit" || fail "the service outlived its program"
[ -e "$config" ] || fail "removal took the configuration"
[ ! -e /usr/bin/stickslipd ] || fail "removal left the program"
dpkg -P stickslip >>"$results/dpkg.txt" 2>&1 || fail "dpkg -P"
[ ! -e "$config" ] || fail "purge left the configuration"
[ "$(kept)" = "$before" ] || fail "removal touched records"
! systemctl cat "$unit" >/dev/null 2>&1 || fail "purge left the unit"
find / -xdev \( -path /proc -o -path /sys -o -path /run -o -path /results -o -path "$data" -o -path /var/log \) -prune -o -name '*stickslip*' -print >"$results/left"
dpkg --audit >"$results/audit"
journalctl --no-pager -u "$unit" >"$results/unit.txt"
say "removed"

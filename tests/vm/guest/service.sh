# shellcheck shell=dash
# The unit in a whole Debian: started, at work, without a board, with it again, stopped.
set -eu
unit=stickslipd.service
socket=/run/stickslip/control.sock
switches=/sys/module/stickslip_tester/parameters
results=/results

say() { echo "$(cut -d' ' -f1 /proc/uptime) s: $*"; }

fail() {
  say "FAILED: $*"
  systemctl status --no-pager "$unit" || true
  exit 1
}

property() { systemctl show --value --property "$1" "$unit"; }

await() {
  left=60
  until stickslip status --json --socket "$socket" 2>/dev/null | grep -qE "^  \"$1\": $2"; do
    left=$((left - 1))
    [ "$left" -gt 0 ] || fail "$1 = $2 did not come"
    sleep 1
  done
  stickslip status --json --socket "$socket" >"$results/$3.json"
}

# What an installed package leaves behind.
install -m 0755 stickslipd stickslip /usr/bin/
install -D -m 0644 stickslipd.service "/etc/systemd/system/$unit"
install -D -m 0644 stickslipd.toml /etc/stickslip/stickslipd.toml
install -D -m 0644 codes.bin /lib/firmware/stickslip-codes.bin
echo 'u stickslip - "stickslip" /var/lib/stickslip' | systemd-sysusers -
systemctl daemon-reload

modprobe comedi
insmod ./stickslip_tester.ko
udevadm settle
stat -c '%a %U %G' /dev/comedi0 >"$results/device"

systemctl start "$unit"
say "started"
systemctl is-active "$unit"
await state '"acquiring"' started
await current_test '[0-9]' testing
pid=$(property MainPID)
cp "/proc/$pid/status" "$results/process"
getent group iocard | cut -d: -f3 >"$results/iocard"
id -u stickslip >"$results/user"
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

systemctl stop "$unit"
for name in ActiveState Result ExecMainStatus NRestarts; do
  echo "$name=$(property $name)"
done >"$results/end"
[ ! -e "$socket" ] || fail "the control socket outlived the daemon"
stat -c '%a %U %G %n' /var/lib/stickslip/records/* >"$results/files"
cp -r /var/lib/stickslip/records "$results/"
journalctl --no-pager -u "$unit" >"$results/unit.txt"
say "stopped"

# shellcheck shell=dash
# The service of the package, in a whole Debian: sourced by scripts that run there.
# shellcheck disable=SC2034  # used there
unit=stickslipd.service
socket=/run/stickslip/control.sock
config=/etc/stickslip/stickslipd.toml
results=/results

say() { echo "$(cut -d' ' -f1 /proc/uptime) s: $*"; }

fail() {
  say "FAILED: $*"
  systemctl status --no-pager "$unit" || true
  exit 1
}

property() { systemctl show --value --property "$1" "$unit"; }

# await KEY VALUE WHEN: until the status has it; keeps the status.
await() {
  left=60
  until stickslip status --json --socket "$socket" 2>/dev/null | grep -qE "^  \"$1\": $2"; do
    left=$((left - 1))
    [ "$left" -gt 0 ] || fail "$1 = $2 did not come"
    sleep 1
  done
  stickslip status --json --socket "$socket" >"$results/$3.json"
}

# shellcheck shell=dash
# Sourced by the scripts of the small guests: daemons at a board, and their status.
set -eu

say() { echo "$(cut -d' ' -f1 /proc/uptime) s: $*"; }

fail() {
  say "FAILED: $*"
  exit 1
}

# use NAME: the daemon that the other functions speak of; its records, log and status go to /results/NAME.
use() {
  name=$1
  folder=/results/$name
  socket=/run/$name/control.sock
  mkdir -p "$folder" "/run/$name"
}

# configure [LINE...]: what all scenarios share, then more tables. $chosen: lines of [board.comedi].
configure() {
  cat >"/run/$name/stickslipd.toml" <<TOML
[board]
driver = "comedi"
[board.comedi]
${chosen:-}
[tester]
sled_mass = "2331 g"
load_cell_gain = "2 N/V"
load_cell_zero = "${load_cell_zero:-0 V}"
[record]
folder = "$folder/records"
[control]
socket = "$socket"
TOML
  printf '%s\n' "$@" >>"/run/$name/stickslipd.toml"
}

# start_daemon [COMMAND...]: the command, if any, starts it.
start_daemon() {
  "$@" stickslipd --config "/run/$name/stickslipd.toml" 2>>"$folder/daemon.log" &
  echo $! >"/run/$name/pid"
}

daemon() { cat "/run/$name/pid"; }

# status WHEN: keeps what the daemon says of itself.
status() { stickslip status --json --socket "$socket" >"$folder/$1.json"; }

# await KEY VALUE [SECONDS]: until the status has it; VALUE is a regular expression.
await() {
  key=$1 value=$2 left=${3:-60}
  until [ -S "$socket" ] && stickslip status --json --socket "$socket" 2>/dev/null | grep -qE "^  \"$key\": $value"; do
    kill -0 "$(daemon)" || fail "$name: the daemon ended while $key = $value was awaited"
    left=$((left - 1))
    [ "$left" -gt 0 ] || {
      status given-up
      fail "$name: $key = $value did not come: $(cat "$folder/given-up.json")"
    }
    sleep 1 # asking costs the guest more than waiting
  done
}

# Ends it as systemd would; its exit status must be 0.
stop_daemon() {
  kill -TERM "$(daemon)"
  wait "$(daemon)" || fail "$name: the daemon ended with $?"
}

# shellcheck shell=dash
# An upgrade under a daemon that measures: there are a configuration of its own, a batch, results that wait for a broker, a test under
# way, and the journal of a test in which the daemon was killed.
set -eu
. ./unit.sh
data=/var/lib/stickslip

dpkg -i old.deb >"$results/dpkg.txt" 2>&1 || fail "dpkg -i: $(cat "$results/dpkg.txt")"
cp stickslipd.toml "$config"
cp short.toml long.toml /etc/stickslip
systemctl restart "$unit"
await state '"acquiring"' started
stickslip batch begin --name "liner 42" --operator Ada --pull-speed "12 in/min" --replicates 3 --slides 2 --socket "$socket"
say "installed"

# await_long_test: until a journal is longer than that of the short scene can be (60 kB); its path.
await_long_test() {
  left=120
  until journal=$(find "$data/records" -name '*.journal' -size +100k) && [ -n "$journal" ]; do
    left=$((left - 1))
    [ "$left" -gt 0 ] || fail "no long test"
    sleep 1
  done
  echo "$journal"
}

# A short test, then one that outlasts the guest: killed in it, the daemon is started again by systemd, and the journal comes
# back later, as with a disk that was away.
killed=$(await_long_test)
pid=$(property MainPID)
systemctl kill --signal=KILL "$unit"
while [ -e "/proc/$pid" ]; do sleep 0.1; done
mv "$killed" /var/tmp/killed.journal
say "killed"
running=$(await_long_test)
mv /var/tmp/killed.journal "$killed"
stickslip batch --json --socket "$socket" >"$results/batch-before.json"
(cd "$data/outbox" && ls) >"$results/outbox-before"
cp "$data/token" /run/token
pid=$(property MainPID)
say "at work"

# As apt asks nobody where nobody is there.
dpkg --force-confdef --force-confold -i new.deb >>"$results/dpkg.txt" 2>&1 || fail "upgrade: $(cat "$results/dpkg.txt")"
dpkg-query -W -f '${Version}\n' stickslip >"$results/version"
await state '"acquiring"' upgraded
[ "$(property MainPID)" != "$pid" ] || fail "the daemon of before goes on"
[ "$(property NRestarts)" = 0 ] || fail "the new daemon was started more than once"
say "upgraded"

cmp stickslipd.toml "$config" || fail "the upgrade changed $config"
cmp /run/token "$data/token" || fail "the upgrade changed the token"
for journal in "$killed" "$running"; do
  [ ! -e "$journal" ] || fail "$journal became no record"
done
mkdir "$results/records"
cp "${killed%.journal}.h5" "$results/records/killed.h5"
cp "${running%.journal}.h5" "$results/records/running.h5"
await test_count '[1-9]' after
# The short test of each of the three daemons and the two long ones; a test is counted before its record is made.
left=60
until [ "$(find "$data/records" -name '*.h5' | wc -l)" -ge 5 ]; do
  left=$((left - 1))
  [ "$left" -gt 0 ] || fail "fewer than five records"
  sleep 1
done
find "$data/records" -name '*.h5' -exec stickslip verify --json {} + >"$results/verify.json" || true # Some are interrupted.
stickslip batch --json --socket "$socket" >"$results/batch-after.json"
(cd "$data/outbox" && ls) >"$results/outbox-after"

# shellcheck shell=dash
# Records on ext4 and vfat, each in a file that is mounted: recorded, killed and recovered, judged.
. /lib.sh
# The kernel would ask /sbin/modprobe for the tables of names, which is not there.
for module in loop vfat nls_cp437 nls_ascii nls_utf8; do
  modprobe "$module"
done
gunzip -c /filesystems/ext4.gz >/tmp/ext4.img
truncate -s 64M /tmp/vfat.img
mkdosfs /tmp/vfat.img

# on_disk SCENE: the daemon's configuration, with simulated tests and records on that disk.
on_disk() {
  cat >"/run/$name/stickslipd.toml" <<TOML
[board]
driver = "simulated"
[board.simulated]
scenes = ["/filesystems/$1.toml"]
repeats = 1
[record]
folder = "$records"
[control]
socket = "$socket"
TOML
}

# tell WHAT COMMAND...: keeps what it says, and its exit status.
tell() {
  what=$1
  shift
  status=0
  "$@" >"$folder/$what" 2>&1 || status=$?
  echo "$status" >"$folder/$what.status"
}

for system in ext4 vfat; do
  use "$system"
  disk=/mnt/$system
  records=$disk/records
  mkdir -p "$disk"
  mount -t "$system" -o loop "/tmp/$system.img" "$disk"

  on_disk scene
  tell doctor.json stickslip doctor --config "/run/$name/stickslipd.toml" --json
  stickslipd --config "/run/$name/stickslipd.toml" 2>"$folder/daemon.log" || fail "$system: the daemon ended with $?"
  tell recorded.json stickslip verify --json "$records"/*.h5
  say "$system: recorded"

  on_disk long
  start_daemon
  await current_test '[0-9]'
  sleep 2
  status at-work
  # It belongs to the daemon, which holds its lock.
  tell live stickslip recover "$records"
  kill -KILL "$(daemon)"
  wait "$(daemon)" || true
  tell journal.json stickslip verify --json "$records"/*.journal
  tell recovered stickslip recover "$records"
  tell all.json stickslip verify --json "$records"/*.h5
  ls -a "$records" >"$folder/names"
  mkdir "$folder/records"
  cp "$records"/*.h5 "$folder/records"
  umount "$disk"
  say "$system: recovered"
done

# Sourced by the tests that work in a bare Debian 12 in a folder, as root and with Debian's archive. They set `root`, that folder.

# Runs this script in mount and process namespaces of its own and exits with its code. There, it sets `work`, a folder that is removed at the end.
# The namespaces end with the script, so no mount is left in $work when it is removed.
apart() {
  if [ -n "${RTMSIM_APART:-}" ]; then
    work=$RTMSIM_APART
    return 0
  fi
  local code=0
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  RTMSIM_APART=$work unshare --mount --pid --fork --kill-child --propagation private "$0" "$@" || code=$?
  exit $code
}

# archives: a line of sources.list for each archive of Debian 12 that this machine's apt uses.
archives() { apt-cache policy | sed -nE 's#^ +[0-9]+ (https?://[^ ]+/debian(-security)?) (bookworm(-updates|-security)?)/main .*#deb \1 \3 main#p' | sort -u; }

# archive: the URL of the first one.
archive() {
  local url
  url=$(archives | sed -n 's#^deb \(.*\) bookworm main#\1#p' | head -n 1)
  [ -n "$url" ] || { echo "$(basename "$0"): this machine's apt knows no archive of Debian 12" >&2; return 2; }
  echo "$url"
}

# make_root [COPY]: installs Debian's minimal system into $root, or copies COPY, a folder from debootstrap.
make_root() {
  if [ $# -gt 0 ]; then
    cp -a "$1" "$root"
  else
    local url
    url=$(archive)
    command -v debootstrap >/dev/null || { echo "$(basename "$0"): debootstrap is missing: apt-get install debootstrap" >&2; return 2; }
    debootstrap --variant=minbase bookworm "$root" "$url" >"$root.log" || { cat "$root.log" >&2; return 1; }
    archives >"$root/etc/apt/sources.list"
  fi
  printf '#!/bin/sh\nexit 101\n' >"$root/usr/sbin/policy-rc.d"  # starts no services
  chmod +x "$root/usr/sbin/policy-rc.d"
  # The certificate authorities that this machine's administrator has added.
  mkdir -p "$root/usr/local/share/ca-certificates"
  find /usr/local/share/ca-certificates -name '*.crt' -exec cp {} "$root/usr/local/share/ca-certificates/" \; 2>/dev/null || true
}

# Mounts /proc, /sys and a /dev of its own in $root. $root itself stays a plain folder: inside, / is no mount point.
enter_root() {
  local device
  cp /etc/resolv.conf "$root/etc/"
  mount -t proc proc "$root/proc"
  mount -t sysfs -o ro sysfs "$root/sys"
  mount -t tmpfs -o mode=755 tmpfs "$root/dev"
  mkdir -m 1777 "$root/dev/shm"
  mkdir "$root/dev/pts"
  mount -t devpts -o newinstance,ptmxmode=666,mode=620 devpts "$root/dev/pts"
  ln -s pts/ptmx "$root/dev/ptmx"
  for device in null zero full random urandom tty; do cp -a /dev/$device "$root/dev/"; done
  ln -s /proc/self/fd "$root/dev/fd"
  for device in 0/stdin 1/stdout 2/stderr; do ln -s "/proc/self/fd/${device%/*}" "$root/dev/${device#*/}"; done
}

# inside [NAME=VALUE...] COMMAND...: as root, with no more environment than this.
inside() { chroot "$root" env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root "$@"; }

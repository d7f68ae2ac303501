#!/usr/bin/env bash
# ./run fresh [VERB...] : does a new machine get from nothing to a result?
# Makes a bare Debian 12 in a temporary folder, puts a clone of the current commit into it and
# nothing else, and calls ./run VERB there (default: demo, then test). Prints what time and disk each
# verb took: packages, as only those of the verb are installed, and build. Needs root and 10 GB.
#
# The mounts live in a mount namespace of their own and processes in a process namespace of their
# own: both end with this script, however it ends, so that only the folder is left to remove.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/common.sh
source scripts/common.sh

# The mirror that this machine's apt uses for Debian 12, in either format of its lists.
debian_mirror() {
  local mirror
  mirror=$(cat /etc/apt/sources.list /etc/apt/sources.list.d/*.{list,sources} 2>/dev/null |
    grep -oE 'https?://[^ ]+/debian/?( |$)' | head -n 1 || true)
  echo "${mirror:-http://deb.debian.org/debian}"
}

# megabytes FOLDER: what it takes on its disk, without what is mounted in it.
megabytes() { du -sx --block-size=1MB "$1" | cut -f 1; }

# enter ROOT VERB...: the part inside the namespaces.
enter() {
  local root=$1 verb before after lines=()
  shift
  mount -t proc proc "$root/proc"
  mount --rbind /dev "$root/dev"
  for verb in "$@"; do
    say "bare Debian 12: ./run $verb"
    before=$(megabytes "$root")
    SECONDS=0
    env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 \
      chroot "$root" bash -c "cd /work/lightfit && ./run $verb" </dev/null ||
      die "fresh: ./run $verb failed on a bare Debian 12 after $SECONDS s"
    after=$(megabytes "$root")
    lines+=("$(awk -v verb="./run $verb" -v seconds="$SECONDS" -v before="$before" -v after="$after" \
      'BEGIN { printf "%s: %d s, %.1f GB more, %.1f GB in all", verb, seconds,
               (after - before) / 1000, after / 1000 }')")
  done
  say "fresh: all went well on a bare Debian 12"
  printf '%s\n' "${lines[@]}"
}

if [[ ${1-} == --inside ]]; then
  shift
  enter "$@"
  exit
fi

((EUID == 0)) || die "fresh needs root, to make a file system and mount in it: sudo ./run fresh $*"
command -v git >/dev/null || install_packages git
command -v debootstrap >/dev/null || install_packages debootstrap
git diff --quiet HEAD 2>/dev/null || say "note: changes that are not committed are left out"
folder=$(mktemp -d "${TMPDIR:-/tmp}/lightfit_fresh.XXXXXX")
root=$folder/root
inside=  # process id of unshare, which ignores milder signals and takes its children along
leave() {
  [[ -z $inside ]] || { kill -KILL "$inside" && wait "$inside"; } 2>/dev/null || true
  rm -rf --one-file-system "$folder"
}
trap leave EXIT
trap 'exit 130' INT TERM

say "making a bare Debian 12 from $(debian_mirror)"
debootstrap --variant=minbase bookworm "$root" "$(debian_mirror)" >"$folder/log" 2>&1 ||
  { tail -n 20 "$folder/log" >&2 && die "fresh: debootstrap failed, see above"; }
cp /etc/resolv.conf /etc/hosts "$root/etc/"
git clone --quiet --no-hardlinks "$PWD" "$root/work/lightfit"
if (($# == 0)); then set -- demo test; fi
# In the background, so that a signal ends this script at once and not after the last verb.
unshare --mount --pid --fork --kill-child scripts/fresh.sh --inside "$root" "$@" &
inside=$!
wait "$inside"

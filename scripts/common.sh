# scripts/ : what ./run and its longer verbs (one file each) share. Sourced from the repository's
# root, never run.
# shellcheck shell=bash

say() { printf '\n== %s\n' "$*" >&2; }

die() {
  printf 'run: %s\n' "$*" >&2
  exit 1
}

# missing_packages LIST...: the packages named in these files that are not installed.
missing_packages() {
  LC_ALL=C comm -23 \
    <(sed 's/#.*//' "$@" | xargs -n1 | LC_ALL=C sort -u) \
    <(dpkg-query -W -f='${db:Status-Abbrev}${Package}\n' | sed -n 's/^ii //p' | LC_ALL=C sort -u)
}

# need_packages LIST...: installs what is missing. Ten milliseconds when nothing is.
need_packages() {
  command -v apt-get >/dev/null || die "this script installs with apt-get, which is not here." \
    "Install what $* name with your own package manager, then: cmake --workflow --preset release"
  local missing
  mapfile -t missing < <(missing_packages "$@")
  ((${#missing[@]})) || return 0
  install_packages "${missing[@]}"
}

# install_packages PACKAGE...: as root, or through sudo.
install_packages() {
  local as_root=()
  if ((EUID != 0)); then
    command -v sudo >/dev/null || die "these packages are missing; install them as root, then" \
      "call again:"$'\n'"  apt-get update && apt-get install -y --no-install-recommends $*"
    as_root=(sudo)
  fi
  local apt_get=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o=Dpkg::Use-Pty=0)
  local install=("${apt_get[@]}" install -y --no-install-recommends "$@")
  say "installing packages: $*"
  # A bare system has no package lists, an old one has lists that name files gone from the mirror.
  if ! "${install[@]}" --dry-run &>/dev/null || ! "${install[@]}" >/dev/null; then
    "${apt_get[@]}" update || die "apt-get update failed: is the network, or the mirror named in" \
      "/etc/apt/sources.list*, within reach?"
    "${install[@]}" >/dev/null || die "apt-get could not install: $*. lightfit is built on" \
      "Debian 12 (bookworm); other releases may name these packages differently."
  fi
}

# How many compilers may run at once: one for each core, and 2 GB of memory for each.
num_jobs() {
  local cores memory_kb limit
  cores=$(nproc)
  memory_kb=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo)
  limit=$(cat /sys/fs/cgroup/memory.max 2>/dev/null || echo max)  # a container's own limit, bytes
  if [[ $limit != max ]] && ((limit / 1024 < memory_kb)); then memory_kb=$((limit / 1024)); fi
  local jobs=$((memory_kb / 2000000))
  if ((jobs > cores)); then jobs=$cores; fi
  if ((jobs < 1)); then jobs=1; fi
  echo "$jobs"
}

# build PRESET [TARGET...]: configures when that has not been done, then builds.
build() {
  local preset=$1 stamp=build/$1/.configured
  shift
  need_packages packages.txt
  if [[ ! -e build/$preset/build.ninja || ! $stamp -nt CMakePresets.json ]]; then
    say "configuring build/$preset"
    cmake --preset "$preset" || die "configuring failed, see above. If build/$preset comes from" \
      "another machine or folder, delete it and call again."
    touch "$stamp"
  fi
  nice ninja -C "build/$preset" -j "$(num_jobs)" "$@"
}

# sources: every C++ file of the project, tracked or not.
sources() {
  find . \( -path ./build -o -path ./out -o -path ./.git \) -prune -o \
    -type f \( -name '*.h' -o -name '*.cc' \) -print | sort
}

# scripts/ : what ./run and its longer verbs (one file each) share. Sourced from the repository's
# root, never run.
# shellcheck shell=bash

# A clone in another folder finds this one's objects in ccache: paths are hashed relative to the
# repository, and neither the precompiled headers' own flags nor __TIME__ stand in the way.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros \
  CCACHE_PCH_EXTSUM=1

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

# The parts of a build that a verb may leave out: what switches them on, and what they need.
#
# One folder for each preset, and not one for each verb: `./run demo` configures the program alone,
# so that nothing else need be installed; `./run test` adds parts to the same build/release, whose
# libraries are compiled already, with the same flags and precompiled headers.
parts=(tests python bench heavy_examples)
declare -A option_of=(
  [tests]=LIGHTFIT_BUILD_TESTS [python]=LIGHTFIT_BUILD_PYTHON [bench]=LIGHTFIT_BUILD_BENCH
  [heavy_examples]=LIGHTFIT_TEST_HEAVY_EXAMPLES)
declare -A packages_of=(
  [tests]=packages-test.txt [python]=packages-test.txt [bench]=packages-bench.txt
  [heavy_examples]=packages-examples.txt)

# configure PRESET [+PART...] [-PART...]: with these parts, without those, and others as they were:
# absent from a new build. Does nothing when all that has been done.
configure() {
  local preset=$1 cache=build/$1/CMakeCache.txt stamp=build/$1/.configured part had want
  shift
  local words=" $* " options=() lists=(packages.txt) fresh=()
  if [[ ! -e build/$preset/build.ninja || ! $stamp -nt CMakePresets.json ]]; then fresh=(--fresh); fi
  local changed=${#fresh[@]}
  for part in "${parts[@]}"; do
    had=OFF want=OFF
    if grep -qs "^${option_of[$part]}:BOOL=ON" "$cache"; then had=ON want=ON; fi
    if [[ $words == *" +$part "* ]]; then want=ON; fi
    if [[ $words == *" -$part "* ]]; then want=OFF; fi
    if [[ $want != "$had" ]]; then changed=1; fi
    if [[ $want == ON ]]; then lists+=("${packages_of[$part]}"); fi
    options+=("-D${option_of[$part]}=$want")
  done
  need_packages "${lists[@]}"
  ((changed)) || return 0
  say "configuring build/$preset"
  cmake "${fresh[@]}" --preset "$preset" "${options[@]}" || die "configuring failed, see above." \
    "If build/$preset comes from another machine or folder, delete it and call again."
  touch "$stamp"
}

# build PRESET [TARGET...]: as configured.
build() {
  local preset=$1
  shift
  nice ninja -C "build/$preset" -j "$(num_jobs)" "$@"
}

# sources: every C++ file of the project, tracked or not.
sources() {
  find . \( -path ./build -o -path ./out -o -path ./.git \) -prune -o \
    -type f \( -name '*.h' -o -name '*.cc' \) -print | sort
}

# benchmarks: the name of every program in bench/.
benchmarks() {
  find bench -name CMakeLists.txt -exec sed -nE 's/^lightfit_benchmark\(([a-z0-9_]+).*/\1/p' {} + |
    sort
}

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs the system packages that are missing, configures, builds, and runs, tests or installs Haptos.
set -euo pipefail

# Needed to build and run (Debian 12 and its relatives).
packages=(
  g++ cmake ninja-build
  trilinos-all-dev libptscotch-dev          # Trilinos' CMake files want PT-Scotch too
  libopenmpi-dev openmpi-bin
  libexodusii-dev libmetis-dev libeigen3-dev
  libopenblas-dev libsuitesparse-dev        # SuiteSparse: CHOLMOD
  libmuparser-dev nlohmann-json3-dev
)
# Needed for `test` only: Fortran, a Python environment and the libraries that the wheels of gmsh and VTK load.
test_packages=(gfortran python3-venv libgl1 libglu1-mesa libxrender1 libxcursor1 libxft2 libxinerama1)
python_packages=(netCDF4 h5py scipy gmsh pyvista matplotlib mpi4py)     # go to build/venv; tests that need them are skipped without

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd -P)
preset=release
build= log=                                  # set by select_preset
packages_changed=0

usage() {
  cat <<'USAGE'
usage: ./bootstrap.sh [build]                       install what is missing, configure, build
       ./bootstrap.sh run FILE.xml [args...]        ... and solve FILE.xml; -n N sets the number of MPI ranks
       ./bootstrap.sh test [ctest args...]          ... and run the tests (without those labelled slow,
                                                    unless -L, -LE or -R selects tests)
       ./bootstrap.sh install PREFIX                ... and install programs, libraries and headers
       ./bootstrap.sh help
Option for all: --preset release|debug|sanitize     (default: release)
Environment:    HAPTOS_JOBS=N            parallel jobs (default: what cores and memory allow)
                HAPTOS_EXTRA_PACKAGES    more Debian packages to install
USAGE
}

say() { printf '[%(%H:%M:%S)T] %s\n' -1 "$*"; }
warn() { printf '[%(%H:%M:%S)T] %s\n' -1 "$*" >&2; }
die() { warn "error: $*"; exit 1; }

# Runs a command with its output in the log; shows the end of the log if it fails.
logged() {
  printf '\n$ %s\n' "$*" >>"$log"
  "$@" >>"$log" 2>&1 </dev/null || fail_with_log "$1"
}

fail_with_log() {
  warn "error: $1 failed; the end of $log:"
  tail -n 40 "$log" | sed 's/^/    /' >&2
  exit 1
}

select_preset() {
  grep -qF "\"name\": \"$preset\"" "$root/CMakePresets.json" || die "unknown preset '$preset'; see CMakePresets.json"
  build=$root/build/$preset
  log=$build/bootstrap.log
  mkdir -p "$build"
  : >"$log"
}

# --- system packages ---------------------------------------------------------------------------------

missing_packages() {
  local name
  for name in "$@"; do
    { dpkg-query -W -f='${db:Status-Status}\n' "$name" 2>/dev/null || true; } | grep -qx installed ||
      printf '%s\n' "$name"
  done
}

as_root() {
  if ((EUID == 0)); then "$@"; else sudo -n "$@"; fi
}

apt() {
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=300 "$@" </dev/null >>"$log" 2>&1
}

# apt-get update is slow: only when a package has no candidate yet.
apt_knows() {
  local name
  for name in "$@"; do
    apt-cache show --no-all-versions "$name" >/dev/null 2>&1 || return 1
  done
}

install_packages() {
  local wanted=("$@") missing
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    warn "not a Debian-like system: please see that these packages, or what they are called here, are installed:"
    warn "  ${wanted[*]}"
    return
  fi
  mapfile -t missing < <(missing_packages "${wanted[@]}")
  ((${#missing[@]})) || return 0

  if ((EUID != 0)) && ! sudo -n true 2>/dev/null; then
    die "these packages are missing and installing them takes root; please run" $'\n' \
        "   sudo apt-get update && sudo apt-get install -y --no-install-recommends ${missing[*]}"
  fi
  say "installing ${missing[*]}"
  local updated=0
  if ! apt_knows "${missing[@]}"; then
    apt update || warn "apt-get update failed; trying with the package lists at hand"
    updated=1
  fi
  if ! apt install --no-install-recommends "${missing[@]}"; then
    ((!updated)) || fail_with_log "apt-get install"
    apt update && apt install --no-install-recommends "${missing[@]}" || fail_with_log "apt-get install"
  fi
  packages_changed=1
}

# --- configure and build -----------------------------------------------------------------------------

# Why CMake has to run; empty if it need not.  Changes of known CMake files are left to ninja.
reason_to_configure() {
  local cache=$build/CMakeCache.txt
  if [[ ! -f $cache || ! -f $build/build.ninja ]]; then
    echo "first time"
  elif ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$cache"; then
    echo "the checkout was moved"
  elif ((packages_changed)); then
    echo "packages were installed"
  elif [[ $root/CMakePresets.json -nt $build/build.ninja ]] ||
       [[ -n $(find "$root"/{packages,drivers,tests} -name CMakeLists.txt -newer "$build/build.ninja" 2>/dev/null) ]]; then
    echo "CMake files are new"
  fi
}

configure() {
  local why
  why=$(reason_to_configure)
  [[ -n $why ]] || return 0
  say "configuring $preset ($why)"
  # The cache of another folder or another set of packages would mislead CMake.
  case $why in
    "CMake files are new") logged cmake -S "$root" --preset "$preset" ;;
    *) logged cmake -S "$root" --preset "$preset" --fresh ;;
  esac
}

# One job per core and per 1.75 GB of memory that is free.
# nproc would count the threads that OpenMP may use, which is none of make's business.
count_cores() { env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc; }

parallel_jobs() {
  if [[ -n ${HAPTOS_JOBS:-} ]]; then
    [[ $HAPTOS_JOBS =~ ^[1-9][0-9]*$ ]] || die "HAPTOS_JOBS must be a positive number, not '$HAPTOS_JOBS'"
    echo "$HAPTOS_JOBS"
    return
  fi
  local cores free_kb limit file
  cores=$(count_cores)
  free_kb=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo 2>/dev/null || true)
  for file in /sys/fs/cgroup/memory.max /sys/fs/cgroup/memory/memory.limit_in_bytes; do
    limit=$(cat "$file" 2>/dev/null || true)
    if [[ $limit =~ ^[0-9]{1,15}$ ]] && ((limit / 1024 < ${free_kb:-999999999})); then free_kb=$((limit / 1024)); fi
  done
  local by_memory=$((${free_kb:-1835008} / 1835008))
  ((by_memory < cores)) && cores=$by_memory
  ((cores > 0)) || cores=1
  echo "$cores"
}

# Passes on, every 20 s, how far ninja's "[done/total]" has come.
show_progress() {
  local line last=$SECONDS
  while IFS= read -r line; do
    if [[ $line =~ ^\[([0-9]+)/([0-9]+)\] ]] && ((SECONDS - last >= 20)); then
      say "  ${BASH_REMATCH[1]} of ${BASH_REMATCH[2]}"
      last=$SECONDS
    fi
  done
}

build_targets() {
  local jobs command start=$SECONDS
  jobs=$(parallel_jobs)
  command=(cmake --build "$build" --parallel "$jobs" --target "$@")
  say "building $* ($preset, $jobs at a time; details in build/$preset/bootstrap.log)"
  printf '\n$ %s\n' "${command[*]}" >>"$log"
  "${command[@]}" </dev/null 2>&1 | tee -a "$log" | show_progress || fail_with_log "the build"
  say "built in $((SECONDS - start)) s"
}

prepare() {
  install_packages "${packages[@]}" ${HAPTOS_EXTRA_PACKAGES:-}
  configure
}

# --- commands ----------------------------------------------------------------------------------------

do_build() {
  (($# == 0)) || die "build takes no arguments, but got '$*'"
  prepare
  build_targets all
  say "programs are in build/$preset/bin"
}

do_run() {
  local ranks='' args=()
  while (($#)); do
    case $1 in
      -n|--ranks) (($# > 1)) || die "-n needs the number of MPI ranks"; ranks=$2; shift 2 ;;
      *) args+=("$1"); shift ;;
    esac
  done
  ((${#args[@]})) || die "run needs an input file: ./bootstrap.sh run FILE.xml"
  [[ ${args[0]} == -* || -f ${args[0]} ]] || die "no such input file: ${args[0]} (seen from $PWD)"
  local cores
  cores=$(count_cores)
  [[ -n $ranks ]] || ranks=$((cores < 4 ? cores : 4))
  [[ $ranks =~ ^[1-9][0-9]*$ ]] || die "-n needs a positive number of MPI ranks, not '$ranks'"
  prepare
  build_targets bin/haptos
  run_on_ranks "$ranks" "$build/bin/haptos" "${args[@]}"
}

# Leaves the script: its exit status is the program's.
run_on_ranks() {
  local ranks=$1
  shift
  # No binding: Open MPI would put the first rank of every run on core 0, and runs side by side would share it.
  local mpi=(mpirun --bind-to none -n "$ranks")
  ((EUID != 0)) || mpi+=(--allow-run-as-root)
  ((ranks <= $(physical_cores))) || mpi+=(--oversubscribe)
  export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1   # the ranks are the parallelism
  say "running on $ranks MPI rank(s)"
  exec "${mpi[@]}" "$@"
}

# What Open MPI counts as slots.
physical_cores() {
  { lscpu -p=CORE,SOCKET 2>/dev/null || true; } | { grep -v '^#' || true; } | sort -u | wc -l
}

# Best effort: without network the tests that need these packages are skipped.
prepare_python() {
  local venv=$root/build/venv stamp=$root/build/venv/haptos-packages
  if [[ -x $venv/bin/python && $(cat "$stamp" 2>/dev/null) == "${python_packages[*]}" ]]; then return; fi
  say "Python packages for tests: ${python_packages[*]}"
  { python3 -m venv --clear "$venv" &&
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --retries 1 --timeout 20 \
      "${python_packages[@]}" &&
    printf '%s' "${python_packages[*]}" >"$stamp"; } >>"$log" 2>&1 </dev/null ||
    warn "NOTICE: could not install ${python_packages[*]} (no network?): the tests that need them are SKIPPED"
}

do_test() {
  install_packages "${test_packages[@]}"
  prepare
  prepare_python
  build_targets all
  local selection=(-LE slow) arg
  for arg in "$@"; do
    case $arg in -L*|-R*|--label-*|--tests-regex*) selection=() ;; esac
  done
  say "testing"
  # Tests written in Python take the python3 of the environment; where it lacks a package they are skipped.
  export PATH=$root/build/venv/bin:$PATH
  # two more than there are cores: tests wait for programs to start and for ranks
  ctest --test-dir "$build" --output-on-failure --no-tests=error -j "$(($(count_cores) + 2))" "${selection[@]}" "$@"
}

do_install() {
  (($# == 1)) || die "install needs one folder: ./bootstrap.sh install PREFIX"
  local prefix
  prefix=$(realpath -m -- "$1")
  prepare
  build_targets all
  logged cmake --install "$build" --prefix "$prefix"
  say "installed to $prefix; use it with -DCMAKE_PREFIX_PATH=$prefix"
}

main() {
  local args=()
  while (($#)); do
    case $1 in
      --preset) (($# > 1)) || die "--preset needs a name"; preset=$2; shift 2 ;;
      --preset=*) preset=${1#*=}; shift ;;
      *) args+=("$1"); shift ;;
    esac
  done
  set -- "${args[@]}"
  local command=${1:-build}
  (($# == 0)) || shift
  case $command in
    build|run|test|install) select_preset; "do_$command" "$@" ;;
    help|-h|--help) usage ;;
    *) usage >&2; die "unknown command '$command'" ;;
  esac
}

main "$@"

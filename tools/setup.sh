# SPDX-FileCopyrightText: The Isophote authors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# What the front doors ./isophote and ./check share; they source it with $root set to the checkout.
# Everything here speaks on stderr: stdout belongs to the program. `check` sets $for_tests, for what only tests need.

say() { printf 'isophote: %s\n' "$*" >&2; }

package_lists() { cat "$root/tools/packages" ${for_tests:+"$root/tools/packages-for-tests"}; }

# The packages of these lists, without comments.
needed_packages() { package_lists | sed -e 's/#.*//' -e '/^ *$/d' -e 's/ *$//'; }

missing_packages() {
  for package in $(needed_packages); do
    status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null) || status=missing
    [ "$status" = installed ] || printf '%s ' "$package"
  done
}

# Installs what is missing. A stamp that holds the list's checksum saves asking the package manager every time;
# a failed build removes it.
set_up() {
  stamp="$root/build/packages${for_tests:+-for-tests}.stamp"
  checksum=$(package_lists | cksum)
  if [ -r "$stamp" ]; then
    read -r installed <"$stamp"
    [ "$installed" = "$checksum" ] && return 0
  fi
  if [ -z "${ISOPHOTE_NO_INSTALL:-}" ]; then install_packages || return 1; fi
  mkdir -p "$root/build" && printf '%s\n' "$checksum" >"$stamp"
}

install_packages() {
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    say "this system has no apt-get; please install what these Debian packages hold, then set ISOPHOTE_NO_INSTALL=1:"
    package_lists | sed -e '/^#/d' -e 's/^/  /' >&2
    return 1
  fi
  missing=$(missing_packages)
  [ -n "$missing" ] || return 0
  if [ "$(id -u)" = 0 ]; then
    as_root=
  elif command -v sudo >/dev/null; then
    as_root=sudo
  else
    say "please install the missing packages as root: apt-get install $missing"
    return 1
  fi
  say "installing ${missing% }"
  if [ -t 2 ]; then apt_get "$missing" >&2; return; fi
  log="$root/build/packages.log"
  mkdir -p "$root/build"
  if ! apt_get "$missing" >"$log" 2>&1; then
    tail -n 30 "$log" >&2
    say "apt-get failed; its whole output is in $log"
    return 1
  fi
}

# shellcheck disable=SC2086  # Both are lists of words.
apt_get() {
  $as_root apt-get update </dev/null &&
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends $1 </dev/null
}

# build PRESET TARGET: configures where needed, then builds. Shows progress on a terminal, and the compiler's words
# where it fails.
build() {
  folder="$root/build/$1"
  mkdir -p "$folder"
  if [ ! -e "$folder/build.ninja" ]; then
    say "configuring the $1 build"
    if ! (cd "$root" && cmake --preset "$1") >"$folder/configure.log" 2>&1; then
      cat "$folder/configure.log" >&2
      rm -f "$root"/build/packages*.stamp
      say "cmake failed; the lines above say why"
      return 1
    fi
  fi
  # Where no file is newer than the last build of this target, or nobody watches, only a failure is worth a word.
  stamp="$folder/$2.stamp"
  watched=
  if [ ! -e "$stamp" ] || [ -n "$(changed_since "$stamp")" ]; then
    if [ -t 2 ]; then watched=yes
    elif [ -e "$stamp" ]; then say "building what has changed"
    else say "building (minutes the first time)"
    fi
  fi
  : >"$stamp.new"
  built=yes
  if [ -n "$watched" ]; then
    ninja -C "$folder" "$2" >&2 || built=
  else
    ninja --quiet -C "$folder" "$2" >"$folder/build.log" 2>&1 || { built=; cat "$folder/build.log" >&2; }
  fi
  if [ -z "$built" ]; then
    rm -f "$root"/build/packages*.stamp
    say "the build failed; the lines above say why"
    return 1
  fi
  mv "$stamp.new" "$stamp"
}

changed_since() {
  find "$root/CMakeLists.txt" "$root/CMakePresets.json" "$root/cmake" "$root/src" "$root/tests" "$root/benchmarks" \
    -newer "$1" -print -quit
}

#!/bin/sh
# SPDX-FileCopyrightText: The Isophote authors
# SPDX-License-Identifier: Apache-2.0
# Installs a build into an empty folder, builds the programs of docs/library.md against it alone, and renders with all.
# Then makes the Debian package, unpacks it and runs what is inside.
# Usage: install_test.sh SOURCE_FOLDER BUILD_FOLDER
set -eu
source=$1
build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { printf 'FAILED: %s\n' "$*" >&2; exit 1; }

cmake --install "$build" --prefix "$work/prefix" >"$work/install.log" || { cat "$work/install.log"; fail "cmake --install"; }
for file in bin/isophote include/isophote/isophote.h share/man/man1/isophote.1 \
  share/bash-completion/completions/isophote share/zsh/vendor-completions/_isophote \
  share/isophote/scenes/cornell-original.json share/doc/isophote/README.md; do
  [ -s "$work/prefix/$file" ] || fail "$file was not installed"
done

# The library, from nothing but the installed files.
mkdir "$work/examples"
awk -v folder="$work/examples" '
  /^```cpp$/ { file = folder "/example" ++n ".cpp"; next }
  /^```$/ { file = "" }
  file != "" { print > file }' "$source/docs/library.md"
cmake -S "$source/tests/install/client" -B "$work/client" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DEXAMPLES="$work/examples" -DCMAKE_PREFIX_PATH="$work/prefix" >"$work/client.log" 2>&1 &&
  cmake --build "$work/client" >>"$work/client.log" 2>&1 || { cat "$work/client.log"; fail "the clients do not build"; }
for example in "$work"/examples/*.cpp; do
  (cd "$work" && "./client/$(basename "$example" .cpp)") || fail "$(basename "$example") does not run"
done
for picture in cornell.png corner.exr; do
  [ -s "$work/$picture" ] || fail "the examples wrote no $picture"
done

# The program.
"$work/prefix/bin/isophote" render cornell-box -o "$work/program.png" --width 32 --photons 1000 --quiet
[ -s "$work/program.png" ] || fail "the installed program wrote no picture"

grep -q 'isophote view' "$work/prefix/share/man/man1/isophote.1" || fail "the manual does not describe isophote view"

# The manual page, where there is something that reads it.
if command -v groff >/dev/null; then
  warnings=$(groff -ww -man -Tutf8 -z "$work/prefix/share/man/man1/isophote.1" 2>&1) || fail "groff: $warnings"
  [ -z "$warnings" ] || fail "the manual page: $warnings"
fi

# Completion in bash: commands, options, values, keys of --set, scenes.
complete_words() { # complete_words WORD...: what completes the last word
  bash -c '. "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _isophote; printf "%s\n" "${COMPREPLY[@]}"' \
    bash "$work/prefix/share/bash-completion/completions/isophote" "$@"
}
expect() { # expect ANSWER WORD...
  answer=$1
  shift
  complete_words "$@" | grep -qx -- "$answer" || fail "completing \"$*\" does not offer $answer"
}
expect render isophote re
expect --photons isophote render --pho
expect kdtree isophote render cornell-box --estimator k
expect --script isophote view --scr
expect ispm isophote view atrium --preset i
expect photon_trace.photons= isophote render cornell-box --set photon_trace.ph
expect cornell-box isophote render cornell-b
expect aces isophote render cornell-box --tonemap a
if command -v zsh >/dev/null; then
  zsh -n "$work/prefix/share/zsh/vendor-completions/_isophote" || fail "zsh cannot read its completion"
fi

# The Debian package.
if command -v dpkg-shlibdeps >/dev/null; then
  cpack --config "$build/CPackConfig.cmake" -B "$work/package" >"$work/package.log" 2>&1 || { cat "$work/package.log"; fail "cpack"; }
  package=$(echo "$work"/package/isophote_*.deb)
  dpkg-deb --field "$package" Depends | grep -q embree || fail "the package does not depend on Embree"
  dpkg-deb --field "$package" Depends | grep -q libglfw3 || fail "the package does not depend on GLFW"
  dpkg-deb --extract "$package" "$work/unpacked"
  "$work/unpacked/usr/bin/isophote" info --builtin | grep -q cornell-box || fail "the packaged program does not run"
  [ -s "$work/unpacked/usr/share/man/man1/isophote.1" ] || fail "the package holds no manual"
else
  echo "the Debian package is not tested: dpkg-shlibdeps (package dpkg-dev) is not installed"
fi
echo "installed, linked and packaged"

#!/bin/bash
# Shows Pelage on this machine: installs what is missing (Debian 12 package names), builds the command, grows hair on a
# mannequin and renders it into out/. Where the folder of real grooms is there (PELAGE_DATA, default ../shared/data),
# they are rendered too. README.md says where such files are found.
set -euo pipefail
cd "$(dirname "$0")"
. tools/packages.sh
install_packages $PELAGE_BUILD_PACKAGES

cmake --preset release -B build/demo -D PELAGE_TESTS=OFF >/dev/null
cmake --build build/demo
pelage=build/demo/apps/cli/pelage
data=${PELAGE_DATA:-../shared/data}
size=${PELAGE_DEMO_SIZE:-1280x1280}
mkdir -p out

# picture NAME ARGUMENT…: renders out/NAME.png, says so, and shows the command.
pictures=()
picture() {
  local file=out/$1.png
  shift
  echo "+ pelage render $* -o $file"
  "$pelage" render "$@" --size "$size" -o "$file"
  pictures+=("$file")
}

for style in straight wavy curly afro ponytail; do
  "$pelage" grow "$style" -o "out/$style.pelage"
  picture "$style" "out/$style.pelage" --mesh mannequin
done

sintel=$data/grooms/SintelHairOriginal-sintel_hair.16points.tfx
[ -f "$sintel" ] && picture sintel "$sintel" --mesh "$data/meshes/sintel.obj"
ratboy=$data/grooms/Ratboy_mohawk.tfx
[ -f "$ratboy" ] && picture ratboy "$ratboy"

echo
echo "Open these pictures:"
printf '  %s\n' "${pictures[@]/#/$PWD/}"

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
pelage=build/demo/bin/pelage
data=${PELAGE_DATA:-../shared/data}
mkdir -p out

# say COMMAND…: shows the command, then runs it.
say() {
  echo "+ pelage $*"
  "$pelage" "$@"
}
# picture NAME ARGUMENT…: renders out/NAME.png.
pictures=()
picture() {
  local file=out/$1.png
  shift
  say render "$@" --size "${PELAGE_DEMO_SIZE:-1024x1024}" -o "$file"
  pictures+=("$PWD/$file")
}

hair=(straight:light-brown wavy:red curly:brown afro:black ponytail:blond coat:white)
for style in "${hair[@]}"; do
  say grow "${style%:*}" -o "out/${style%:*}.pelage" --write-mesh out/head.obj
  picture "${style%:*}" "out/${style%:*}.pelage" --mesh out/head.obj --hair "${style#*:}"
done

say grow curls --hair-mesh -o out/curls.hairmesh
picture curls-hairmesh out/curls.hairmesh --method swr

sintel=$data/grooms/SintelHairOriginal-sintel_hair.16points.tfx
if [ -f "$sintel" ]; then
  picture sintel "$sintel" --mesh "$data/meshes/sintel.obj" --mesh "$data/meshes/sintel-eyes.obj" --hair red
  picture ratboy "$data/grooms/Ratboy_mohawk.tfx" --mesh "$data/meshes/Ratboy_body.tfxmesh" \
    --mesh "$data/meshes/Ratboy_left_hand.tfxmesh" --mesh "$data/meshes/Ratboy_right_hand.tfxmesh"
else
  echo "No real grooms in $data (README.md says where to find some); set PELAGE_DATA to their folder."
fi

echo
echo "Open these pictures:"
printf '  %s\n' "${pictures[@]}"

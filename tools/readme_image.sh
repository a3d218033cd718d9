#!/bin/bash
# Makes docs/images/hair.png, the picture of the README: three heads of grown hair, side by side (the Debian package
# openimageio-tools puts them there).
set -euo pipefail
cd "$(dirname "$0")/.."
pelage=${PELAGE:-build/release/bin/pelage}
mkdir -p out/readme docs/images
for hair in curly:brown straight:blond wavy:red; do
  style=${hair%:*}
  "$pelage" grow "$style" -o "out/readme/$style.pelage" --write-mesh out/readme/head.obj
  "$pelage" render "out/readme/$style.pelage" --mesh out/readme/head.obj --hair "${hair#*:}" --size 400x480 --spp 16 \
    -o "out/readme/$style.png"
done
oiiotool out/readme/curly.png out/readme/straight.png out/readme/wavy.png --mosaic:pad=4 3x1 --ch R,G,B -o docs/images/hair.png

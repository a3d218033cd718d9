// Uses the installed library through its public headers, from memory to a file and back.
#include <pelage/pelage.h>

#include <cstdio>
#include <memory>
#include <stdexcept>

int main() {
  pelage::GrowSettings settings = pelage::grow_defaults(pelage::HairStyle::kWavy);
  settings.strands = 200;
  settings.points = 16;
  auto hair = std::make_shared<pelage::StrandSet>(pelage::grow(settings, pelage::mannequin_head()));

  pelage::Scene scene;
  scene.grooms.emplace_back().strands = hair;
  scene.settings.width = scene.settings.height = 64;
  pelage::add_default_camera(scene);
  pelage::add_default_lights(scene);
  pelage::write_image("consumer.png", pelage::render(scene).display);

  const pelage::Image image = pelage::read_image("consumer.png");
  if (image.width != 64 || image.height != 64) throw std::runtime_error("the picture has another size");
  std::printf("Pelage %s rendered %zu strands\n", pelage::version(), hair->strand_count());
}

// The options that say what is seen: the same for every verb that makes a picture of a scene.
#include "import_options.h"
#include "render.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

void add_display_options(CLI::App& verb, RenderOptions& o) {
  verb.add_option("--size", o.size, "Pixels, e.g. 1920x1080")->type_name("WxH");
  verb.add_option("--exposure", o.exposure, "Stops")->check(CLI::Range(-100.0, 100.0));
  verb.add_option("--tone-map", o.tone_map, "Curve of PNG output: aces, none")->type_name("NAME");
  verb.add_option("--background", o.background, "Linear R,G,B, or transparent");
}

void add_world_options(CLI::App& verb, RenderOptions& o) {
  add_camera_options(verb, o);
  verb.add_option("--light", o.lights, "directional:DX,DY,DZ:R,G,B or point:X,Y,Z:R,G,B; replaces the lights; may be repeated")
      ->type_name("LIGHT")
      ->allow_extra_args(false);
  verb.add_option("--env", o.environment, "Latitude-longitude image that lights the scene")->type_name("FILE");
  verb.add_option("--env-rotation", o.environment_rotation, "Degrees about +Y")->check(CLI::Range(-3600.0, 3600.0));
  verb.add_flag("--env-visible", o.environment_visible, "Show the environment behind the scene");
  verb.add_flag("--no-shadows", o.no_shadows, "Light passes through everything");
}

void add_hair_options(CLI::App& verb, RenderOptions& o) {
  verb.add_option("--hair", o.hair, "black, brown, light-brown, blond, red, gray or white")->type_name("NAME");
  verb.add_option("--color", o.color, "Linear color of a dense tuft, 0…1")
      ->delimiter(',')
      ->expected(3)
      ->type_name("R,G,B")
      ->check(CLI::Range(0.0, 1.0));
  verb.add_option("--melanin", o.melanin, "Eumelanin and pheomelanin")
      ->delimiter(',')
      ->expected(1, 2)
      ->type_name("E[,P]")
      ->check(CLI::Range(0.0, 100.0));
  verb.add_option("--model", o.model, "Fiber scattering: kajiya-kay, marschner, zhu, chiang, sadeghi, pelekis")
      ->type_name("NAME");
  verb.add_option("--width-scale", o.width_scale, "Multiplies every width")->check(CLI::PositiveNumber);
}

}  // namespace

std::vector<CLI::Option*> add_thick_hair_options(CLI::App& verb, RenderOptions& o) {
  return {
      verb.add_option("--lod-pixels", o.lod_pixels, "Widest thick hairs of grooms that have them (pelage lod build), pixels")
          ->check(CLI::Range(0.1, 64.0))
          ->type_name("PIXELS"),
      verb.add_option("--lod-error", o.lod_error,
                      "How much FLIP beside all strands may be predicted of thick hairs (try 0.05), instead of --lod-pixels; "
                      "0: by width. Not for cards")
          ->check(CLI::Range(0.0, 0.2))
          ->excludes("--lod-pixels")
          ->type_name("FLIP"),
      verb.add_option("--lod-level", o.lod_level,
                      "One level of thick hairs everywhere, 0 the coarsest, instead of --lod-pixels and --lod-error")
          ->check(CLI::Range(0, 15))
          ->type_name("LEVEL"),
      verb.add_option("--lod-scattering", o.lod_scattering, "Thick hairs scatter as the bundle they stand for, or as one fiber")
          ->type_name("aggregate|fiber")};
}

void add_camera_options(CLI::App& verb, RenderOptions& o) {
  verb.add_option("--mesh", o.meshes, "Opaque mesh (OBJ, PLY, glb, tfxmesh); may be repeated")
      ->type_name("FILE")
      ->allow_extra_args(false);
  verb.add_flag("--no-head", o.no_head,
                "Leave away the mannequin, which shows below hair that was grown on it when no --mesh is given");
  add_import_options(verb, o.import);
  verb.add_option("--eye", o.eye, "Where the camera stands")->delimiter(',')->expected(3)->type_name("X,Y,Z");
  verb.add_option("--target", o.target, "What it looks at")->delimiter(',')->expected(3)->type_name("X,Y,Z");
  verb.add_option("--fov", o.fov, "Full vertical angle, degrees")->check(CLI::Range(0.01, 179.0));
  verb.add_option("--turn", o.turn, "Takes the camera around the target, degrees")->check(CLI::Range(-3600.0, 3600.0));
  verb.add_flag("--ortho", o.orthographic, "Orthographic camera");
}

void add_scene_options(CLI::App& verb, RenderOptions& options) {
  add_display_options(verb, options);
  add_world_options(verb, options);
  add_hair_options(verb, options);
}

}  // namespace pelage::cli

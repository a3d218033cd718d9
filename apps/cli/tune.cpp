// pelage tune filter: the size of the linking filter's kernel that comes nearest to a reference.
#include <fmt/format.h>
#include <pelage/metrics.h>
#include <pelage/pelage.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/atomic_file.h"
#include "render.h"
#include "terminal.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

using Json = nlohmann::ordered_json;

struct TuneVerb {
  RenderOptions scene;
  std::vector<std::string> inputs;
  std::vector<float> radii{2, 3, 4, 5, 6, 7, 8, 10, 12}, kernel_sizes, aspects{RenderSettings().link.aspect};
  std::vector<float> falloffs{RenderSettings().link.falloff};
  int reference_samples = 64;
  std::string output;
  bool json = false;

  /// What the sizes of the kernels are: k of eq. 13 where it is given, else the radius of the kernel that adapts.
  bool published() const { return !kernel_sizes.empty(); }
  const std::vector<float>& sizes() const { return published() ? kernel_sizes : radii; }
  const char* size_name() const { return published() ? "kernel_size" : "kernel_radius"; }
  std::size_t kernel_count() const { return falloffs.size() * aspects.size() * sizes().size(); }
  /// Kernel i: sizes turn fastest, then aspects.
  void choose(std::size_t i, LinkSettings& link) const {
    const std::size_t n = sizes().size();
    (published() ? link.kernel_size : link.kernel_radius) = sizes()[i % n];
    link.aspect = aspects[i / n % aspects.size()], link.falloff = falloffs[i / n / aspects.size()];
  }
};

/// Mean squared errors of one scene, linear, over the pixels that its hair covers.
struct Case {
  std::string name;
  double input = 0;           ///< of one sample a pixel, without link and filter
  std::vector<double> error;  ///< by kernel
};

double error_of(const Image& test, const Image& reference, const PixelMask& mask) {
  CompareOptions options;
  options.metrics = {"mse"}, options.mask = mask;
  return compare_images({test}, {reference}, options).value("mse").value_or(0);
}

/// One scene by all kernels; reference and light maps are made once.
Case measure(const TuneVerb& verb, const std::string& input, const Progress& progress, std::vector<std::string>& notes) {
  RenderOptions options = verb.scene;
  options.input = input;
  Scene scene = make_scene(options, progress, notes);
  RenderSettings& settings = scene.settings;
  const auto picture = [&](Method method, int samples) {
    settings.method = method, settings.samples = samples;
    return render(scene, progress).linear;
  };
  settings.view = View::kCoverage;
  const PixelMask mask = hair_mask({picture(Method::kMsaa, 1), Encoding::kLinear, input});
  settings.view = View::kBeauty;
  const Image reference = picture(Method::kSsaa, verb.reference_samples);
  Case result{input, error_of(picture(Method::kMsaa, 1), reference, mask), {}};
  for (std::size_t i = 0; i < verb.kernel_count(); ++i) {
    verb.choose(i, settings.link);
    result.error.push_back(error_of(picture(Method::kLink, 1), reference, mask));
  }
  return result;
}

/// Mean over the cases of the error as a share of the input's: a bright scene counts as much as a dark one.
std::vector<double> mean_shares(const std::vector<Case>& cases) {
  std::vector<double> mean(cases.front().error.size());
  for (const Case& c : cases)
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += c.error[i] / c.input / static_cast<double>(cases.size());
  return mean;
}

/// The curve of every case and their mean over the kernel's size, for the best shape, as an SVG picture.
std::string plot(const TuneVerb& verb, const std::vector<Case>& cases, const std::vector<double>& mean, std::size_t best) {
  const std::size_t sizes = verb.sizes().size(), first = best / sizes * sizes;
  double top = 0;
  for (const Case& c : cases)
    for (std::size_t i = 0; i < sizes; ++i) top = std::max(top, c.error[first + i] / c.input);
  const double right = static_cast<double>(*std::max_element(verb.sizes().begin(), verb.sizes().end()));
  const auto x = [&](std::size_t i) { return 60 + 420 * static_cast<double>(verb.sizes()[i]) / std::max(right, 1e-9); };
  const auto y = [&](double share) { return 280 - 250 * share / std::max(top, 1e-9); };
  const auto line = [&](const std::string& style, const auto& share) {
    std::string points;
    for (std::size_t i = 0; i < sizes; ++i) points += fmt::format("{:.1f},{:.1f} ", x(i), y(share(i)));
    return fmt::format("<polyline fill=\"none\" {} points=\"{}\"/>\n", style, points);
  };
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 500 330\" font-family=\"sans-serif\" font-size=\"12\">\n"
      "<rect width=\"500\" height=\"330\" fill=\"white\"/>\n<path d=\"M60 30V280H480\" fill=\"none\" stroke=\"black\"/>\n";
  for (const Case& c : cases) svg += line("stroke=\"#999\"", [&](std::size_t i) { return c.error[first + i] / c.input; });
  svg += line("stroke=\"#c30\" stroke-width=\"2\"", [&](std::size_t i) { return mean[first + i]; });
  for (std::size_t i = 0; i < sizes; ++i)
    svg += fmt::format("<text x=\"{:.1f}\" y=\"296\" text-anchor=\"middle\">{}</text>\n", x(i), verb.sizes()[i]);
  svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"#c30\"/>\n", x(best - first), y(mean[best]));
  svg += fmt::format(
      "<text x=\"54\" y=\"34\" text-anchor=\"end\">{:.2f}</text><text x=\"54\" y=\"284\" text-anchor=\"end\">0</text>\n", top);
  svg += fmt::format("<text x=\"270\" y=\"318\" text-anchor=\"middle\">{}</text>\n",
                     verb.published() ? "kernel size k" : "kernel radius, pixels");
  return svg +
         "<text x=\"70\" y=\"22\">mean squared error, as a share of one sample's; red: mean of the cases</text>\n</svg>\n";
}

void print_table(const TuneVerb& verb, const std::vector<Case>& cases, const std::vector<double>& mean, std::size_t best) {
  fmt::print("{:>13} {:>8} {:>8} {:>10}", verb.size_name(), "aspect", "falloff", "mean");
  for (const Case& c : cases) fmt::print(" {:>12.12}", c.name.substr(c.name.find_last_of('/') + 1));
  fmt::print("   error as a share of one sample's\n");
  for (std::size_t i = 0; i < mean.size(); ++i) {
    LinkSettings link;
    verb.choose(i, link);
    fmt::print("{:>13} {:>8} {:>8} {:>10.4f}", verb.sizes()[i % verb.sizes().size()], link.aspect, link.falloff, mean[i]);
    for (const Case& c : cases) fmt::print(" {:>12.4f}", c.error[i] / c.input);
    fmt::print("{}\n", i == best ? "   best" : "");
  }
}

Json kernel_json(const TuneVerb& verb, std::size_t i) {
  LinkSettings link;
  verb.choose(i, link);
  return {{verb.size_name(), verb.sizes()[i % verb.sizes().size()]}, {"aspect", link.aspect}, {"falloff", link.falloff}};
}

void print_json(const TuneVerb& verb, const std::vector<Case>& cases, const std::vector<double>& mean, std::size_t best) {
  Json json{{"best", kernel_json(verb, best)}};
  for (std::size_t i = 0; i < mean.size(); ++i) {
    Json row = kernel_json(verb, i);
    row["share"] = mean[i];
    for (const Case& c : cases) row["mse"].push_back(c.error[i]);
    json["kernels"].push_back(row);
  }
  for (const Case& c : cases) json["cases"].push_back({{"input", c.name}, {"mse_of_one_sample", c.input}});
  fmt::print("{}\n", json.dump(2));
}

/// Before the long work: the name, and whether it can be written.
void check_plot(const std::string& path) {
  if (!path.ends_with(".svg")) throw UsageError("--output", path, "the plot is an SVG picture", "call it name.svg");
  const io::AtomicFile probe(path);
}

void tune_filter(const TuneVerb& verb) {
  if (!verb.output.empty()) check_plot(verb.output);
  std::vector<std::string> notes;
  std::vector<Case> cases;
  {
    ProgressLine line;
    const Progress progress = line.callback();
    for (const std::string& input : verb.inputs) cases.push_back(measure(verb, input, progress, notes));
  }
  const std::vector<double> mean = mean_shares(cases);
  const auto best = static_cast<std::size_t>(std::min_element(mean.begin(), mean.end()) - mean.begin());
  if (!verb.output.empty()) {
    const std::string svg = plot(verb, cases, mean, best);
    io::AtomicFile file(verb.output);
    file.write(svg);
    file.commit();
  }
  for (const std::string& note : notes) fmt::print(stderr, "pelage: {}\n", note);
  if (verb.json) print_json(verb, cases, mean, best);
  else print_table(verb, cases, mean, best);
}

}  // namespace

void add_tune(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("tune", "Choose parameters of a method by what comes nearest to a reference");
  verb->require_subcommand(1);
  CLI::App* filter = verb->add_subcommand("filter", "The kernel of the linking filter, by least mean squared error on hair");
  auto o = std::make_shared<TuneVerb>();
  filter->add_option("INPUT", o->inputs, "Groom files or scene files, each a case")->type_name("FILE")->required();
  filter->add_option("--radii", o->radii, "Radii to try: half of the length for thin hair, pixels")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 64.0))
      ->type_name("A,B");
  filter
      ->add_option("--kernel-sizes", o->kernel_sizes,
                   "Instead, sizes k of eq. 13: half of the length over the size of the hair")
      ->delimiter(',')
      ->check(CLI::Range(1e-6, 1.0))
      ->type_name("A,B");
  filter->add_option("--aspects", o->aspects, "Aspects to try")->delimiter(',')->check(CLI::Range(0.0, 1.0))->type_name("A,B");
  filter->add_option("--falloffs", o->falloffs, "Standard deviations over half of the axes to try")
      ->delimiter(',')
      ->check(CLI::Range(1e-3, 1e6))
      ->type_name("A,B");
  filter->add_option("--reference-spp", o->reference_samples, "Samples a pixel of the reference, each shaded")
      ->check(CLI::Range(1, 4096));
  filter->add_option("-o,--output", o->output, "Plot of the errors over the size")->type_name("FILE.svg");
  filter->add_flag("--json", o->json, "Print JSON");
  add_scene_options(*filter, o->scene);
  add_machine_options(*filter);
  filter->footer(
      "Renders every case by `--method ssaa` once and by `--method link` with every kernel.\n"
      "Example:\n"
      "  pelage tune filter straight.pelage curly.pelage --size 960x540 -o kernel.svg");
  filter->callback([o] { tune_filter(*o); });
}

}  // namespace pelage::cli

// The pelage command: `pelage VERB …`. Exit status 0 done, 1 failed, 2 wrong usage.
#include <fmt/format.h>
#include <pelage/pelage.h>

#include <csignal>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "core/nearest.h"
#include "terminal.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

constexpr int kFailed = 1, kUsage = 2;

void add_verbs(CLI::App& app) {
  add_grow(app);
  add_fit(app);
  add_lod(app);
  add_simulate(app);
  add_info(app);
  add_convert(app);
  add_render(app);
  add_compare(app);
  add_trace(app);
  add_denoise(app);
  add_report(app);
  add_tune(app);
  add_bench(app);
}

void configure(CLI::App& app) {
  app.name("pelage");
  app.description("Renders, makes and converts hair and fur, strand by strand.");
  app.footer(
      "Examples:\n"
      "  pelage grow curly -o curly.pelage\n"
      "  pelage render curly.pelage -o curly.png\n"
      "  pelage VERB --help");
  app.set_version_flag("--version", fmt::format("pelage {}", version()));
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  add_verbs(app);
}

CLI::App& chosen_verb(CLI::App& app) {
  const std::vector<CLI::App*> verbs = app.get_subcommands();
  return verbs.empty() ? app : *verbs.front();
}

std::vector<std::string> option_names(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::vector<std::string> verb_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) names.push_back(verb->get_name());
  return names;
}

// What was typed, what was wrong with it, and what was probably meant.
std::string usage_message(CLI::App& app, const CLI::ParseError& error) {
  CLI::App& verb = chosen_verb(app);
  for (const std::string& extra : app.remaining(true)) {
    const std::string typed = extra.substr(0, extra.find('='));
    if (typed.size() > 1 && typed[0] == '-') {
      const std::string nearest = nearest_name(typed, option_names(verb));
      return fmt::format("unknown option {}; did you mean {}?", typed, nearest);
    }
    if (&verb == &app) return fmt::format("unknown verb {}; did you mean {}?", typed, nearest_name(typed, verb_names(app)));
    return fmt::format("unexpected argument {}", typed);
  }
  return error.what();
}

int report_usage(CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
  const CLI::App& verb = chosen_verb(app);
  const std::string help = &verb == &app ? "pelage --help" : fmt::format("pelage {} --help", verb.get_name());
  fmt::print(stderr, "pelage: {}\nTry `{}`.\n", usage_message(app, error), help);
  return kUsage;
}

int fail(std::string_view message) {
  // Whoever interrupted knows; the shell learns it from the signal.
  if (const int signal = interrupted_by()) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
  fmt::print(stderr, "pelage: {}\n", message);
  return kFailed;
}

int run(int argc, char** argv) {
  CLI::App app;
  configure(app);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& e) {
    return report_usage(app, e);
  } catch (const UsageError& e) {
    fmt::print(stderr, "pelage: {}\n", e.what());
    return kUsage;
  } catch (const std::bad_alloc&) {
    return fail("not enough memory for this; try fewer samples, a smaller picture or fewer strands");
  } catch (const std::exception& e) {
    return fail(e.what());
  }
}

}  // namespace

void add_machine_options(CLI::App& verb) {
  verb.add_option_function<int>(
          "--threads", [](int n) { set_thread_count(n); }, "Threads to use; 0 one per core")
      ->check(CLI::Range(0, 1024))
      ->type_name("N");
  verb.add_option_function<std::string>(
          "--isa", [](const std::string& isa) { set_isa(isa); }, "Instruction set to use instead of the best")
      ->check(CLI::IsMember(available_isas()));
}

}  // namespace pelage::cli

int main(int argc, char** argv) { return pelage::cli::run(argc, argv); }

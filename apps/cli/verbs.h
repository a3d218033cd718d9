// The verbs of the pelage command. Each adds its subcommand, with its options, its help and the work as callback;
// each stands in the file of its name. The order in add_verbs() (main.cpp) is the order of the help.
#pragma once

#include <pelage/error.h>

#include <CLI/CLI.hpp>

namespace pelage::cli {

/// A wrong option or value: exit status 2.
struct UsageError : Error {
  using Error::Error;
};

void add_render(CLI::App& app);
void add_grow(CLI::App& app);
void add_fit(CLI::App& app);
void add_lod(CLI::App& app);
void add_simulate(CLI::App& app);
void add_info(CLI::App& app);
void add_convert(CLI::App& app);
void add_compare(CLI::App& app);
void add_trace(CLI::App& app);
void add_denoise(CLI::App& app);
void add_report(CLI::App& app);
void add_tune(CLI::App& app);
void add_bench(CLI::App& app);

/// Adds --threads and --isa, which act as they are parsed.
void add_machine_options(CLI::App& verb);

}  // namespace pelage::cli

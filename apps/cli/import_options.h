// --scale, --up and --width: the same words wherever a groom is read.
#pragma once

#include <pelage/io.h>

#include <CLI/CLI.hpp>
#include <string>

namespace pelage::cli {

/// Adds the options; they are written to `options` as they are parsed, so it must live until then.
void add_import_options(CLI::App& verb, ImportOptions& options);

/// The lines to show a person after an import: what was assumed and repaired. Empty when nothing was.
std::string import_summary(const ImportReport& report);

}  // namespace pelage::cli

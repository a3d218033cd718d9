// The public entry points for grooms: detect, read, place, repair; and the way back.
#include <pelage/error.h>
#include <pelage/io.h>

#include <fmt/format.h>

#include <algorithm>

#include "io/hair_mesh_formats.h"
#include "io/place_strands.h"
#include "io/strand_registry.h"
#include "io/told.h"

namespace pelage {

namespace io {

StrandSet read_strands(const ByteSource& source, const ImportOptions& options, ImportReport* report, const Progress& progress) {
  ImportReport own;
  ImportReport& told = report ? *report : own;
  told = {};
  const StrandFormat& format = detect_strand_format(source);
  told.format = format.info.name;
  FileStrands file = format.read(source, progress);
  if (file.strands.strand_count() == 0)
    throw Error(source.name(), "", "a groom of 0 strands", "export it again with its strands selected");
  told.notes = std::move(file.notes);
  place_strands(file, options, told);
  told.repairs = repair(file.strands);
  if (file.strands.strand_count() == 0)
    throw Error(source.name(), "", "no usable strand: " + told.repairs.summary(), "export the groom again");
  tell(progress, "io.read", 1, source.name());
  return std::move(file.strands);
}

/// Hair meshes say their unit and axes, and their strands need no repair.
static StrandSet strands_of_hair_mesh(const std::string& path, ImportReport* report, const Progress& progress) {
  const HairMesh mesh = pelage::read_hair_mesh(path);
  if (strand_count(mesh) > kMostStrandsOfHairMesh)
    throw Error(path, "", std::to_string(strand_count(mesh)) + " strands at full detail",
                "expand() takes a share of them; render --method swr makes them on the fly");
  if (report) {
    *report = {};
    report->format = "hairmesh";
  }
  return expand(mesh, {}, progress);
}

}  // namespace io

StrandSet read_strands(const std::string& path, const ImportOptions& options, ImportReport* report, const Progress& progress) {
  const io::ByteSource source = io::ByteSource::open(path);
  if (io::hair_mesh_file(source) != io::HairMeshFile::kNone) return io::strands_of_hair_mesh(path, report, progress);
  return io::read_strands(source, options, report, progress);
}

namespace {

std::string extension_of(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  if (dot == std::string::npos || path[dot] != '.') return "";
  std::string extension = path.substr(dot + 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

const io::StrandFormat& format_for_writing(const std::string& path, const std::string& name) {
  const std::string extension = extension_of(path);
  std::string known;
  for (const io::StrandFormat* format : io::strand_registry()) {
    const std::vector<std::string>& ends = format->info.extensions;
    if (!format->info.writes) continue;
    if (name.empty() ? std::find(ends.begin(), ends.end(), extension) != ends.end() : format->info.name == name) return *format;
    known += fmt::format("{}{} (.{})", known.empty() ? "" : ", ", format->info.name, ends.front());
  }
  throw Error(path, "",
              name.empty() ? fmt::format("the extension '{}' names no groom format", extension)
                           : fmt::format("unknown groom format '{}'", name),
              "known: " + known);
}

}  // namespace

std::vector<std::string> write_strands(const std::string& path, const StrandSet& strands, const std::string& format,
                                       const Progress& progress) {
  const io::StrandFormat& chosen = format_for_writing(path, format);
  validate(strands, path);
  if (strands.strand_count() == 0) throw Error(path, "", "a groom of 0 strands cannot be written", "");
  io::AtomicFile file(path);
  std::vector<std::string> lost = chosen.write(file, strands, progress);
  io::tell(progress, "io.write", 1, path);
  file.commit();
  return lost;
}

std::vector<FormatInfo> strand_formats() {
  std::vector<FormatInfo> formats;
  for (const io::StrandFormat* format : io::strand_registry()) formats.push_back(format->info);
  return formats;
}

}  // namespace pelage

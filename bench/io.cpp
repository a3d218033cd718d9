// io: bytes per second from a groom's file, in the page cache, to strands.
#include <pelage/io.h>

#include <stdlib.h>  // mkdtemp

#include <filesystem>

#include "bench.h"
#include "grooms.h"

namespace pelage::bench {
namespace {

/// A file that goes away with its folder.
struct GroomFile {
  std::filesystem::path folder, path;
  std::shared_ptr<const StrandSet> written;

  GroomFile(const std::string& name, const std::string& extension) : written(groom(name)) {
    std::string pattern = (std::filesystem::temp_directory_path() / "pelage-bench-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) throw Skip{"no temporary folder can be made"};
    folder = pattern;
    path = folder / ("groom." + extension);
    write_strands(path.string(), *written);
  }
  GroomFile(const GroomFile&) = delete;
  GroomFile& operator=(const GroomFile&) = delete;
  ~GroomFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
};

/// What both formats hold: the same bits as what was written.
std::string check(const GroomFile& file) {
  const StrandSet read = read_strands(file.path.string());
  if (read.offsets != file.written->offsets) return "the strands differ";
  if (read.points != file.written->points) return "the points differ";
  if (read.widths != file.written->widths) return "the widths differ";
  return "";
}

Workload workload(const std::string& groom, const std::string& extension) {
  const auto file = std::make_shared<GroomFile>(groom, extension);
  return {.check = [file] { return check(*file); },
          .run = [file] { read_strands(file->path.string()); },
          .items = static_cast<double>(std::filesystem::file_size(file->path))};
}

}  // namespace

void add_io_cases(Suite& suite) {
  for (const std::string extension : {"hair", "pelage"})
    suite.cases.push_back({"io.read_" + extension + ".curly50k", "bytes_per_second", "B/s",
                           [extension] { return workload("curly50k", extension); }});
}

}  // namespace pelage::bench

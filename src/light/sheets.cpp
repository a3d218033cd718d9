#include "light/sheets.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"

namespace pelage {
namespace {

constexpr std::size_t kGrain = 1 << 16;

}  // namespace

void fill_parallel(std::uint32_t* values, std::size_t count, std::uint32_t value) {
  parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) { std::fill(values + begin, values + end, value); });
}

Sheets::Sheets(std::size_t count, bool own) : count_(count) {
  if (own) return;
  shared_.resize(count);
  fill_parallel(shared_.data(), count, 0);
}

std::uint32_t* Sheets::mine() {
  if (!shared_.empty()) return shared_.data();
  Buffer<std::uint32_t>& sheet = own_.local();
  if (sheet.empty()) sheet.resize(count_), sheet.fill(0);
  return sheet.data();
}

Buffer<std::uint32_t> Sheets::sum() {
  if (!shared_.empty()) return std::move(shared_);
  mine();  // one at least
  std::vector<const std::uint32_t*> others;
  for (auto sheet = own_.begin() + 1; sheet != own_.end(); ++sheet) others.push_back(sheet->data());
  Buffer<std::uint32_t> all = std::move(*own_.begin());
  parallel_for(count_, kGrain, [&](std::size_t begin, std::size_t end) {
    for (const std::uint32_t* sheet : others)
      for (std::size_t i = begin; i < end; ++i) all[i] += sheet[i];
  });
  return all;
}

}  // namespace pelage

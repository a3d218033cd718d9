// Bad input, told so that its owner can act on it.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace pelage {

/// What every entry point of the library throws on bad input (never on programmer error: see PELAGE_CHECK).
///
/// what() reads `<where>: <place>: <problem> (<remedy>)`, e.g.
/// `groom.hair: strand 4711: 3 points announced, 1 present (the file is truncated; export it again)`.
class Error : public std::runtime_error {
 public:
  Error(std::string where, std::string place, std::string problem, std::string remedy)
      : std::runtime_error(join(where, place, problem, remedy)), where_(std::move(where)), place_(std::move(place)),
        problem_(std::move(problem)), remedy_(std::move(remedy)) {}

  const std::string& where() const { return where_; }      ///< file, option or object; never empty
  const std::string& place() const { return place_; }      ///< byte, line, strand or key inside it; may be empty
  const std::string& problem() const { return problem_; }  ///< what is wrong
  const std::string& remedy() const { return remedy_; }    ///< what to do about it; may be empty

 private:
  static std::string join(const std::string& where, const std::string& place, const std::string& problem,
                          const std::string& remedy) {
    std::string s = where + ": ";
    if (!place.empty()) s += place + ": ";
    s += problem;
    if (!remedy.empty()) s += " (" + remedy + ")";
    return s;
  }
  std::string where_, place_, problem_, remedy_;
};

}  // namespace pelage

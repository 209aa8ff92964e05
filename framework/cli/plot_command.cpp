#include <array>
#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "framework/cli/command.hpp"
#include "framework/cli/printable.hpp"
#include "framework/core/text/fault.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

/// The script that draws, from the folder of the program: in a build folder, and installed.
constexpr std::array kScripts = {"../python/tomlin-plot", "../lib/tomlin/python/tomlin-plot"};

constexpr const char* kSummary = "draw a figure of finished runs, of a sweep or of a study";
/// The script's help has it, too, and all options.
constexpr const char* kPlotFooter = R"(
Examples:

  tomlin plot pt.out -o force.svg
      the friction trace.)";

struct PlotArguments {
  const CLI::App* parser = nullptr;  ///< as long as the command line is read
  std::vector<std::string> words;
};

/// The words are those of the script, --help included.
void take_all_words(CLI::App& parser, PlotArguments& arguments) {
  parser.set_help_flag();
  parser.prefix_command();
  arguments.parser = &parser;
}

void check(PlotArguments& arguments) { arguments.words = arguments.parser->remaining(); }

[[noreturn]] void refuse(const std::string& why) {
  throw InputError({Fault(FaultCode::plot_no_matplotlib, {"tomlin"}, "", "",
                          "figures are drawn in Python: " + why,
                          "the Python module of tomlin (./dev python), with NumPy and matplotlib "
                          "(Debian: python3-numpy, python3-matplotlib)")});
}

int plot(const PlotArguments& arguments) {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  std::vector<std::string> words = {""};
  words.insert(words.end(), arguments.words.begin(), arguments.words.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::string why;
  for (const char* script : kScripts) {
    words[0] = (folder / script).lexically_normal().string();
    pointers[0] = words[0].data();
    ::execv(words[0].c_str(), pointers.data());
    // The interpreter of a script may be missing, too.
    why += fmt::format("{}{}: {}", why.empty() ? "" : "; ", words[0],
                       std::generic_category().message(errno));
  }
  for (const std::string& word : arguments.words) {
    if (word != "--help" && word != "-h") continue;
    return print_result(fmt::format("{}\nUsage: tomlin plot DIR... [WHAT] -o FILE\n{}\n\n{}\n",
                                    kSummary, kPlotFooter, why));
  }
  refuse(why);
}

}  // namespace

CommandRecord plot_command() {
  return {"plot", kSummary, kPlotFooter, declared<PlotArguments>(take_all_words, check, plot)};
}

}  // namespace tomlin

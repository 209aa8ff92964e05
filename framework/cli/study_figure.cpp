#include "framework/cli/study_figure.hpp"

#include <exception>
#include <string>

#include "framework/cli/printable.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/plot/gnuplot.hpp"
#include "framework/plot/gnuplot_script.hpp"

namespace tomlin {
namespace {

bool note(const std::exception& error) {
  print_error_line(std::string("note: no figure: ") + error.what());
  return false;
}

}  // namespace

bool write_study_figure(const RunFolder& folder, const std::string& name, const Figure& figure) {
  if (figure.panels.empty()) return false;
  try {
    folder.write_file(name, run_gnuplot(gnuplot_script(figure, PictureFormat::svg)));
    return true;
  } catch (const InputError& error) {
    return note(error);
  } catch (const GnuplotError& error) {
    return note(error);
  }
}

}  // namespace tomlin

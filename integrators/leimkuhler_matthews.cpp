#include "integrators/leimkuhler_matthews.hpp"

#include "integrators/brownian.hpp"

namespace tomlin {
namespace {

struct LeimkuhlerMatthews {
  static constexpr const char* name = "leimkuhler_matthews";
  static constexpr BrownianNoise noise = BrownianNoise::averaged;
};

}  // namespace

IntegratorRecord leimkuhler_matthews_record() {
  IntegratorRecord record = brownian_record<LeimkuhlerMatthews>();
  record.summary =
      "scheme of Leimkuhler and Matthews for noise without inertia, averages at rest of second "
      "order";
  record.equation = "x_n+1 = x_n + h F_n/c + sqrt(2 T h/c) (z_n + z_n+1)/2";
  record.source =
      "B. Leimkuhler and C. Matthews, Appl. Math. Res. Express 2013, 34, doi:10.1093/amrx/abs010; "
      "B. Leimkuhler, C. Matthews and M. V. Tretyakov, Proc. R. Soc. A 470 (2014) 20140120, "
      "doi:10.1098/rspa.2014.0120";
  return record;
}

}  // namespace tomlin

#include "integrators/euler_maruyama.hpp"

#include "integrators/brownian.hpp"

namespace tomlin {
namespace {

struct EulerMaruyama {
  static constexpr const char* name = "euler_maruyama";
  static constexpr BrownianNoise noise = BrownianNoise::of_the_step;
};

}  // namespace

IntegratorRecord euler_maruyama_record() {
  IntegratorRecord record = brownian_record<EulerMaruyama>();
  record.summary = "scheme of Euler and Maruyama for noise without inertia, of first order";
  record.equation = "x <- x + h F/c + sqrt(2 T h/c) z";
  record.source =
      "G. Maruyama, Rend. Circ. Mat. Palermo 4 (1955) 48, doi:10.1007/BF02846028; P. E. Kloeden "
      "and E. Platen, Numerical Solution of Stochastic Differential Equations (1992), "
      "doi:10.1007/978-3-662-12616-5, section 9.1";
  return record;
}

}  // namespace tomlin

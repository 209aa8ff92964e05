#pragma once

#ifdef TOMLIN_HAS_CVODE

#include <algorithm>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

/// SUNDIALS' CVODE on equations written out in a test.
namespace tomlin::test {

/// dy/dt at (t, y).
using Equations = std::function<void(double t, const double* y, double* slope)>;

class Cvode {
 public:
  /// `method`: CV_ADAMS or CV_BDF; both solve their equations by Newton's iteration.
  Cvode(Equations equations, std::vector<double> start, int method, double tolerance)
      : equations_(std::move(equations)), start_(std::move(start)) {
    check(SUNContext_Create(kNoCommunicator, &context_));
    const auto n = static_cast<sunindextype>(start_.size());
    y_ = N_VMake_Serial(n, start_.data(), context_);
    matrix_ = SUNDenseMatrix(n, n, context_);
    solver_ = SUNLinSol_Dense(y_, matrix_, context_);
    cvode_ = CVodeCreate(method, context_);
    check(CVodeInit(cvode_, &Cvode::slope, 0.0, y_));
    check(CVodeSetUserData(cvode_, this));
    check(CVodeSStolerances(cvode_, tolerance, tolerance));
    check(CVodeSetLinearSolver(cvode_, solver_, matrix_));
    check(CVodeSetMaxNumSteps(cvode_, 10'000'000));
  }
  ~Cvode() {
    CVodeFree(&cvode_);
    SUNLinSolFree(solver_);
    SUNMatDestroy(matrix_);
    N_VDestroy(y_);
    SUNContext_Free(&context_);
  }
  Cvode(const Cvode&) = delete;
  Cvode& operator=(const Cvode&) = delete;

  std::vector<double> at(double time) {
    double reached = 0.0;
    check(CVodeSetStopTime(cvode_, time));
    check(CVode(cvode_, time, y_, &reached, CV_NORMAL));
    const double* y = N_VGetArrayPointer(y_);
    return {y, y + start_.size()};
  }

 private:
  static int slope(double t, N_Vector y, N_Vector slope, void* self) {
    static_cast<Cvode*>(self)->equations_(t, N_VGetArrayPointer(y), N_VGetArrayPointer(slope));
    return 0;
  }
  static void check(int flag) {
    if (flag < 0) throw std::runtime_error("CVODE gave up");
  }

  Equations equations_;
  std::vector<double> start_;
#ifdef SUN_COMM_NULL  // since SUNDIALS 7, where MPI may have a value of its own for it
  static inline const SUNComm kNoCommunicator = SUN_COMM_NULL;
#else
  static constexpr std::nullptr_t kNoCommunicator = nullptr;
#endif
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
  void* cvode_ = nullptr;
};

}  // namespace tomlin::test

#endif

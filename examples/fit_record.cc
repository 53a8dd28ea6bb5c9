// Fits a CSV record and prints sigma, alpha and Tc: the library in ten lines.
#include <cstdio>

#include "mindahl/identification/fit.h"
#include "mindahl/io/record_reader.h"

using namespace mindahl::identification;

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const mindahl::loop::Record record = mindahl::io::ReadRecord(argv[1]).record;
  Fitter fitter;
  const FitResult& fit = fitter.Fit(record, Depth::kFull);  // or another depth
  for (const ParameterEstimate& parameter : fit.parameters) {
    std::printf("%-20s %.10g %s\n", parameter.name.c_str(), parameter.value,
                parameter.unit.c_str());
  }
  return fit.converged ? 0 : 3;
}

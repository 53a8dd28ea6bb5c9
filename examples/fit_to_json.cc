// Fits a CSV record and writes what `mindahl fit FILE [--normal-load N] --json -` writes, to the
// byte.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "mindahl/identification/fit.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/report/contact.h"
#include "mindahl/report/report.h"

int main(int argc, char** argv) {
  if (argc != 2 && argc != 3) {
    std::fputs("usage: fit_to_json FILE [NORMAL_LOAD]\n", stderr);
    return 2;
  }
  try {
    mindahl::report::ReportInput input;
    input.records = {mindahl::io::ReadRecord(argv[1])};
    const std::vector<mindahl::loop::Record> records = {input.records.front().record};
    input.fit = mindahl::identification::Fit(records, {.offsets = true},
                                             mindahl::identification::Depth::kFull);
    // The load as given, else the mean of its column where the record has one.
    input.known.normal_load = input.fit.normal_load;
    if (argc == 3) input.known.normal_load = std::strtod(argv[2], nullptr);
    const mindahl::report::Report report = mindahl::report::MakeReport(std::move(input));
    std::fputs(mindahl::report::ToJson(report).c_str(), stdout);
    return report.fit.converged ? 0 : 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fit_to_json: %s\n", error.what());
    return 2;
  }
}

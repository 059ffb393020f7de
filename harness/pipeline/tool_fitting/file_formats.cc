#include "harness/pipeline/tool_fitting/file_formats.h"

#include <array>

namespace touchstone::pipeline {
namespace {

constexpr auto tool_fit_fields = std::to_array<FormatField>({
    {"verdict", "text", "", "what the fit concludes, in a word"},
    {"declared_stiffness_N_per_m", "number or null", "N/m", "of the model that was given"},
    {"declared_rotational_stiffness_Nm_per_rad", "number or null", "Nm/rad", "of the model that was given"},
    {"stiffness_N_per_m", "number or null", "N/m", "fitted"},
    {"rotational_stiffness_Nm_per_rad", "number or null", "Nm/rad", "fitted"},
    {"force_rms_before_N", "number or null", "N", "error on blocks that the fit has not seen"},
    {"force_rms_after_N", "number or null", "N", "the same after the fit"},
    {"torque_rms_before_Nm", "number or null", "Nm", "error of the torque"},
    {"torque_rms_after_Nm", "number or null", "Nm", "the same after the fit"},
    {"force_noise_rms_N", "number or null", "N", "error of the force that noise alone makes"},
    {"torque_noise_rms_Nm", "number or null", "Nm", "error of the torque that noise alone makes"},
    {"misreading", "object or null", "", "how the file seems to be read wrongly"},
    {"misreading.name", "text", "", "of the misreading"},
    {"misreading.what", "text", "", "a sentence"},
    {"effects", "list of objects", "", "one for each effect"},
    {"effects[].name", "text", "", "of the effect"},
    {"effects[].unit", "text", "", "of its values"},
    {"effects[].values", "list of numbers", "its \"unit\"", "fitted values"},
    {"effects[].standard_errors", "list of numbers", "its \"unit\"", "of the values"},
    {"effects[].determined", "list of flags", "", "whether the recording determines each value"},
    {"effects[].p", "number or null", "1", "probability of so large an effect by chance"},
    {"effects[].gain_per_sample", "number or null", "", "gain of the effect for each sample"},
    {"effects[].gain_p", "number or null", "1", "probability of so large a gain by chance"},
    {"effects[].rivals", "list of texts", "", "effects that fit equally well"},
    {"effects[].named", "flag", "", "it is named as missing"},
    {"ambiguous", "list of lists of texts", "", "pairs of effects that fit equally well"},
    {"remarks", "list of texts", "", "what the reader must know"},
});

}  // namespace

std::span<const FileFormat> tool_fitting_file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-tool-fit/1", "tool-fit.json",
       "effects of the instrument and stiffness of the coupling, fitted to recorded force and torque", "`tool fit`", "",
       tool_fit_fields},
  });
  return formats;
}

}  // namespace touchstone::pipeline

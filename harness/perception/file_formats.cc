#include "harness/perception/file_formats.h"

#include <array>

namespace touchstone::perception {
namespace {

constexpr auto hardness_part_fields = std::to_array<FormatField>({
    {"value", "number or null", "N/m", "extended rate hardness"},
    {"interval95", "list of numbers", "N/m", "its interval"},
    {"contacts", "whole number", "", "contacts that it is over"},
});
constexpr FormatPart hardness_part{hardness_part_fields};

constexpr auto paper_condition_fields = std::to_array<FormatField>({
    {"name", "text", "", "of the condition"},
    {"distance", "number or null", "1", "from the real process in the space of perception"},
    {"rank", "whole number", "", "1 is the nearest"},
    {"coordinates", "list of numbers", "1", "in the space of perception"},
    {"distance_by_feature", "object", "", "the same, feature by feature"},
    {"distance_by_feature.*", "number or null", "1", "distance"},
    {"statistics", "object", "", "each statistical method"},
    {"statistics.*", "number or null", "method's unit", "value"},
    {"extended_rate_hardness_N_per_m", "number or null", "N/m", "hardness"},
    {"harmonic_share", "number or null", "1", "share of power in harmonics"},
    {"rate_hardness_guarded_share", "number or null", "1", "share of samples that are too slow for a rate"},
    {"force_reduction", "number or null", "1", "share of samples that the dead band leaves out"},
    {"displacement_reduction", "number or null", "1", "the same of displacement"},
});
constexpr FormatPart paper_condition{paper_condition_fields};

constexpr auto method_part_fields = std::to_array<FormatField>({
    {"name", "text", "", "of the method"},
    {"title", "text", "", "as tables show it"},
    {"unit", "text", "", "of its values"},
    {"larger_is_better", "flag", "", "direction"},
    {"values", "list of numbers", "its \"unit\"", "one for each condition"},
    {"relative_similarity", "list of numbers", "1", "1 is the nearest condition"},
    {"ranking", "list of texts", "", "conditions, best first"},
});
constexpr FormatPart method_part{method_part_fields};

constexpr auto scale_part_fields = std::to_array<FormatField>({
    {"model", "text", "", "Thurstone or Bradley-Terry"},
    {"value", "list of numbers", "1", "scale value of each condition"},
    {"standard_error", "list of numbers", "1", "of the values"},
    {"order_effect", "number or null", "1", "preference of the first of a pair"},
    {"order_effect_error", "number or null", "1", "standard error of that"},
    {"misfit_chi_squared", "number or null", "1", "of the model"},
    {"degrees_of_freedom", "number or null", "1", "of the test"},
    {"misfit_p", "number or null", "1", "of the test"},
    {"remark", "text", "", "what the reader must know"},
});
constexpr FormatPart scale_part{scale_part_fields};

constexpr auto correlation_part_fields = std::to_array<FormatField>({
    {"coefficient", "number or null", "1", "rank correlation"},
    {"interval95", "list of numbers", "1", "its interval"},
    {"p_two_sided", "number or null", "1", "of no correlation"},
});
constexpr FormatPart correlation_part{correlation_part_fields};

constexpr auto perception_2_fields = std::to_array<FormatField>({
    {"method", "text", "", "judge"},
    {"rate_Hz", "number or null", "Hz", "at which it was judged"},
    {"samples", "whole number", "", "of the real process"},
    {"outward", "list of numbers", "1", "direction away from the object"},
    {"repeats", "whole number", "", "repeated recordings of the real process"},
    {"noise_floor_jnd", "object or null", "", "what repeats of the real process differ by, for each channel"},
    {"noise_floor_jnd.*", "number or null", "1", "just noticeable differences"},
    {"extended_rate_hardness_N_per_m", "object or null", "", "of the real process", &hardness_part},
    {"conditions", "list of objects", "", "one for each"},
    {"conditions[].name", "text", "", "of the condition"},
    {"conditions[].noticed_probability", "number or null", "1",
     "share of right answers in a two-alternative forced choice, the best estimate; 0.5 is chance; where the verdict "
     "is "
     "cannot-tell, only its interval says anything"},
    {"conditions[].noticed_interval95", "list of numbers", "1", "its interval"},
    {"conditions[].d_prime", "number or null", "1", "sensitivity"},
    {"conditions[].d_prime_interval95", "list of numbers", "1", "its interval"},
    {"conditions[].verdict", "text", "", "in a word"},
    {"conditions[].above_noise", "flag", "", "differs by more than repeats do"},
    {"conditions[].gives_away", "text or null", "", "channel that shows the difference most"},
    {"conditions[].rank", "whole number", "", "1 is the nearest"},
    {"conditions[].group", "whole number", "", "conditions of one group cannot be ranked"},
    {"conditions[].behind_probability", "number or null", "1", "probability that it is worse than the one before"},
    {"conditions[].channels", "list of objects", "", "what a person can feel"},
    {"conditions[].channels[].name", "text", "", "of the channel"},
    {"conditions[].channels[].jnd", "number or null", "1", "difference, in just noticeable differences"},
    {"conditions[].channels[].probability", "number or null", "1", "of noticing it by this channel alone"},
    {"conditions[].channels[].standard_error_jnd", "number or null", "1", "of jnd"},
    {"conditions[].channels[].what", "text", "", "the difference in words"},
    {"conditions[].channels[].remedy", "text", "", "what would reduce it"},
    {"conditions[].channels[].depth_m", "number or null", "m", "depth that the channel refers to"},
    {"conditions[].unseen_channels", "list of objects", "", "channels that the recording does not show"},
    {"conditions[].unseen_channels[].name", "text", "", "of the channel"},
    {"conditions[].unseen_channels[].why", "text", "", "why not"},
    {"conditions[].places", "list of objects", "",
     "where the real process was pressed, a tenth of its longer side apart"},
    {"conditions[].places[].position_m", "list of numbers", "m", "middle, in the object's frame"},
    {"conditions[].places[].real_N", "number or null", "N",
     "force of the real process at a depth of both; null: one of them was not there"},
    {"conditions[].places[].rendered_N", "number or null", "N", "of the condition, at the same depth"},
    {"conditions[].places[].jnd", "number or null", "1", "difference of the two in just noticeable differences"},
    {"conditions[].places[].standard_error_jnd", "number or null", "1", "of it"},
    {"conditions[].strongest_moment", "object or null", "", "where the difference is most felt"},
    {"conditions[].strongest_moment.t_s", "number or null", "s", "time"},
    {"conditions[].strongest_moment.position_m", "list of numbers", "m", "tip, in the object's frame"},
    {"conditions[].strongest_moment.noticed_share", "number or null", "1", "share of moments that are noticed"},
    {"conditions[].same_motion", "flag", "", "the condition follows the real process's positions"},
    {"conditions[].extended_rate_hardness_N_per_m", "object or null", "", "of the condition", &hardness_part},
    {"conditions[].other_metrics", "object", "", "published measures beside it"},
    {"conditions[].other_metrics.*", "object", "", "a measure"},
    {"conditions[].other_metrics.*.value", "number or null", "its \"unit\"", "value"},
    {"conditions[].other_metrics.*.unit", "text", "", "its unit"},
    {"conditions[].other_metrics.*.larger_is_better", "flag", "", "direction"},
    {"conditions[].other_metrics.*.why?", "text", "", "why it has no value"},
    {"conditions[].remarks", "list of texts", "", "what the reader must know"},
    {"thresholds", "touchstone-thresholds/1", "", "constants that were used"},
});

constexpr auto perception_fields = std::to_array<FormatField>({
    {"rate_Hz", "number or null", "Hz", "at which it was evaluated"},
    {"samples", "whole number", "", "of the real process"},
    {"scaling", "text", "", "of the features"},
    {"features", "list of texts", "", "names"},
    {"dimensions", "whole number", "", "of the space"},
    {"explained_share", "number or null", "1", "share of the variance that they hold"},
    {"components", "whole number", "", "that the data have"},
    {"eigenvalues", "list of numbers", "1", "of the components"},
    {"real", "object", "", "the real process", &paper_condition},
    {"conditions", "list of objects", "", "one for each", &paper_condition},
    {"methods", "list of objects", "", "the space, then each statistical method", &method_part},
    {"scalings", "list of objects", "", "the same space with other scalings"},
    {"scalings[].scaling", "text", "", "of the features"},
    {"scalings[].distances", "list of numbers", "1", "of each condition"},
    {"scalings[].ranking", "list of texts", "", "conditions, nearest first"},
    {"rate_hardness_windows", "list of objects", "", "windows of the rate of force"},
    {"rate_hardness_windows[].samples", "whole number", "", "length"},
    {"rate_hardness_windows[].duration_s", "number", "s", "length"},
    {"rate_hardness_windows[].resolution_m", "number or null", "m", "displacement that it needs"},
    {"rate_hardness_windows[].level_N_per_m", "number or null", "N/m", "hardness with it"},
    {"rate_hardness_windows[].noise_N_per_m", "number or null", "N/m", "its noise"},
    {"rate_hardness_windows[].guarded_share", "number or null", "1", "share of samples that are too slow"},
    {"disagreements", "list of objects", "", "pairs on which the space and a statistic disagree most"},
    {"disagreements[].method", "text", "", "of the statistic"},
    {"disagreements[].nearer_in_space", "text", "", "condition"},
    {"disagreements[].nearer_by_statistic", "text", "", "condition"},
    {"disagreements[].feature", "text", "", "that decides"},
    {"disagreements[].why", "text", "", "a sentence"},
    {"disagreeing_pairs", "object", "", "how many there are, for each statistic"},
    {"disagreeing_pairs.*", "object", "", "a statistic"},
    {"disagreeing_pairs.*.pairs", "whole number", "", "that disagree"},
    {"disagreeing_pairs.*.of", "whole number", "", "all pairs"},
    {"remarks", "list of texts", "", "what the reader must know"},
    {"subjective?", "object", "", "answers of people"},
    {"subjective.subjects", "whole number", "", "people"},
    {"subjective.answers", "whole number", "", "their answers"},
    {"subjective.fraction_preferred", "list of numbers", "1", "of each condition"},
    {"subjective.scales", "list of objects", "", "psychological scales", &scale_part},
    {"subjective.circular_triads", "list of objects", "", "contradictions of each person"},
    {"subjective.circular_triads[].subject", "text", "", "person"},
    {"subjective.circular_triads[].rounds", "whole number", "", "complete rounds"},
    {"subjective.circular_triads[].triads", "number or null", "1", "circular ones"},
    {"subjective.circular_triads[].consistence", "number or null", "1", "Kendall's coefficient"},
    {"subjective.agreement", "list of objects", "", "each method against the people"},
    {"subjective.agreement[].method", "text", "", "of the method"},
    {"subjective.agreement[].spearman?", "object", "", "rank correlation", &correlation_part},
    {"subjective.agreement[].kendall?", "object", "", "rank correlation", &correlation_part},
    {"subjective.agreement[].remark?", "text", "", "why there is none"},
});

constexpr auto thresholds_fields = std::to_array<FormatField>({
    {"force_absolute_N?", "number", "N", "force that is just felt"},
    {"force_breakpoint_N?", "number", "N", "force at which Weber's fraction changes"},
    {"force_fraction_below?", "number", "1", "Weber's fraction below the breakpoint"},
    {"force_fraction_above?", "number", "1", "Weber's fraction above it"},
    {"stiffness_fraction?", "number", "1", "just noticeable change of stiffness"},
    {"depth_fraction?", "number", "1", "how well a hand knows its depth, as deviation of its logarithm"},
    {"direction_rad?", "number", "rad", "just noticeable change of direction"},
    {"friction_fraction?", "number", "1", "just noticeable change of friction"},
    {"position_m?", "number", "m", "just noticeable shift"},
    {"delay_s?", "number", "s", "just noticeable delay of the force behind the motion"},
    {"vibration_fraction?", "number", "1", "just noticeable change of a vibration's amplitude"},
    {"frequency_fraction?", "number", "1", "just noticeable change of a vibration's frequency"},
    {"vibration_integration_s?", "number", "s", "time over which vibration is summed"},
    {"hand_mass_kg?", "number", "kg", "of the hand at the tip"},
    {"hand_damping_N_s_per_m?", "number", "N s/m", "of the hand at the tip"},
    {"hand_stiffness_N_per_m?", "number", "N/m", "of the hand at the tip"},
    {"vibration_threshold?", "object", "", "a measured threshold of vibrating force"},
    {"vibration_threshold.frequency_Hz", "list of numbers", "Hz", "ascending"},
    {"vibration_threshold.amplitude_N", "list of numbers", "N", "amplitude of the sine that is just felt"},
    {"sources?", "object", "", "where each constant is from; not read"},
    {"sources.*", "text", "", "source"},
});

}  // namespace

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-perception/2", "perception.json",
       "whether people would notice each condition against the real process", "`perceive`", "", perception_2_fields},
      {"touchstone-perception/1", "perception.json",
       "the published evaluation: a space of perceptual features (Shao, Wu and Ouyang 2019)",
       "`perceive --method paper`", "", perception_fields},
      {"touchstone-thresholds/1", "thresholds.json",
       "what people can just notice; a file replaces any of the constants (docs/explanation/perception.md)",
       "`perceive` (in perception.json)", "`perceive --thresholds`", thresholds_fields},
  });
  return formats;
}

}  // namespace touchstone::perception

% Holds the functions of +touchstone against files that the program wrote. Octave: octave-cli run_tests.m SOURCE PROGRAM FOLDER
function run_tests()
arguments_given = argv();
[source, program, folder] = arguments_given{end - 2:end};
addpath(fullfile(source, 'extras', 'matlab'));
bundled = fullfile(source, 'synthetic', 'bundled', 'plane');
csv = fullfile(bundled, 'scan.csv');

% One recording in four kinds of file: the same numbers to the bit where the unit is the same.
want = touchstone.read_recording(csv);
assert(size(want.position_m), [1171, 3]);
assert(want.time_s(2), 0.016666666666666666);
assert(want.force_N(1, :), [0.00598, 0.00036, 0.00102]);
assert(size(want.orientation_wxyz), [1171, 4]);
assert(want.orientation_wxyz(1, 1), 0.9994549562218749);
assert(all(abs(sum(want.orientation_wxyz .^ 2, 2) - 1) < 1e-12));
assert(~isfield(want, 'torque_Nm'));
for name = {'scan.h5', 'scan.csv.gz'}
  run(program, sprintf('convert %s %s', csv, fullfile(folder, name{1})));
  got = touchstone.read_recording(fullfile(folder, name{1}));
  assert(isequal(got, want));
end
run(program, sprintf('convert %s %s --length-unit mm --force-unit mN --time-unit ms', csv, fullfile(folder, 'mm.h5')));
got = touchstone.read_recording(fullfile(folder, 'mm.h5'));
assert(got.position_m, want.position_m, -4 * eps);  % there and back: a rounding each
assert(got.force_N, want.force_N, -4 * eps);

% A result and what was rendered, against what the program says of them.
model = fullfile(folder, 'model.json');
handle = fopen(model, 'w');
fprintf(handle, '{"schema": "touchstone-model/1", "renderer": "god-object", "parameters": {"stiffness_N_per_m": 500}}');
fclose(handle);
report = fullfile(folder, 'report');
run(program, sprintf('evaluate --recording %s --mesh %s --mesh-unit mm --model %s --tip-radius 1.5mm --out %s', csv, ...
                     fullfile(bundled, 'plane.obj'), model, report));
result = touchstone.read_result(report);
assert(result.renderer, 'god-object');
assert(numel(result.rendered.time_s), 1171);
assert(islogical(result.rendered.contact));
difference = result.rendered.force_N - want.force_N;
rms = sqrt(mean(sum(difference .^ 2, 2)));
assert(rms, result.metrics.rms_force_error_N, -1e-12);  % the same sum in another order
run(program, sprintf('compare %s %s --json %s', fullfile(report, 'rendered.csv'), fullfile(report, 'rendered.csv'), ...
                     fullfile(folder, 'same.json')));

% The page for users, block by block as written: its shell commands, then its MATLAB.
page = fileread(fullfile(source, 'docs', 'how-to', 'matlab.md'));
copyfile(csv, folder);
copyfile(fullfile(bundled, 'plane.obj'), folder);
before = cd(folder);
shell = blocks(page, 'sh');
assert(numel(shell), 1);
path_before = getenv('PATH');
setenv('PATH', [fileparts(program) ':' path_before]);
[status, output] = system(['set -e; ' shell{1}]);
assert(status == 0, output);
setenv('PATH', path_before);
set(0, 'defaultfigurevisible', 'off');
matlab = blocks(page, 'matlab');
assert(numel(matlab), 1);
% What draws needs a display; the rest must give what the result says.
kept = regexprep(matlab{1}, '(?m)^(plot|xlabel)[^\n]*$', '');
shown = evalc(kept);
assert(~isempty(strfind(shown, 'rms_N = 0.3393')), shown);
cd(before);

% Mistakes are said with the file and what was expected.
fails(@() touchstone.read_recording(fullfile(folder, 'absent.csv')), 'absent.csv: there is no such file');
fails(@() touchstone.read_rendered(csv), 'the column px is missing');
fails(@() touchstone.read_result(model), 'touchstone-result/1 was expected');
odd = fullfile(folder, 'odd.csv');
handle = fopen(odd, 'w');
fprintf(handle, 't_s,x_furlong,y_furlong,z_furlong\n0,1,2,3\n1,1,2,3\n');
fclose(handle);
fails(@() touchstone.read_recording(odd), 'the unit furlong is not known');
printf('all tests of +touchstone passed\n');
end

function found = blocks(page, language)
% The texts of a page's fenced blocks of one language.
found = regexp(page, ['```' language '\n(.*?)```'], 'tokens');
found = cellfun(@(one) one{1}, found, 'UniformOutput', false);
end

function run(program, words)
[status, output] = system([program ' ' words ' 2>&1']);
assert(status == 0, output);
end

function fails(call, expected)
try
  call();
catch problem
  assert(~isempty(strfind(problem.message, expected)), ['"' problem.message '" does not say "' expected '"']);
  return
end
error('"%s" was expected to fail', expected);
end

run_tests();

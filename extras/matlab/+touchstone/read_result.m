function result = read_result(place)
%READ_RESULT  An evaluation of Touchstone: its folder, or result.json in it.
%   result = touchstone.read_result('touchstone-report') has the fields
%     title, renderer   text
%     metrics           a value for each metric, with its unit in the name: metrics.rms_force_error_N. A metric that has
%                       no value is NaN. Units are written out: _per_ for /, _percent for %; "1" has none.
%     rendered          what the renderer answered (see read_rendered), where rendered.csv is there
%     json              the whole file as jsondecode gives it
%   For MATLAB and GNU Octave.
if isfolder(place)
  place = fullfile(place, 'result.json');
end
if ~isfile(place)
  error('touchstone:file', '%s: there is no such file; give the folder of an evaluation or its result.json', place);
end
json = jsondecode(fileread(place));
if ~isfield(json, 'schema') || ~strcmp(json.schema, 'touchstone-result/1')
  error('touchstone:schema', '%s: is no result of an evaluation; the schema touchstone-result/1 was expected', place);
end
result.title = json.title;
result.renderer = json.renderer;
result.metrics = struct();
metrics = json.metrics;
for i = 1:numel(metrics)
  if iscell(metrics)
    one = metrics{i};
  else
    one = metrics(i);
  end
  value = one.value;
  if isempty(value)
    value = NaN;
  end
  result.metrics.(with_unit(one.name, one.unit)) = value;
end
answered = fullfile(fileparts(place), 'rendered.csv');
if isfile(answered)
  result.rendered = touchstone.read_rendered(answered);
end
result.json = json;
end

function name = with_unit(name, unit)
if strcmp(unit, '1')
  return
end
unit = strrep(strrep(strrep(unit, '%', 'percent'), '/', '_per_'), ' ', '');
name = [name '_' regexprep(unit, '[^A-Za-z0-9_]', '')];
end

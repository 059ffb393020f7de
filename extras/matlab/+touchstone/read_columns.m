function columns = read_columns(file)
%READ_COLUMNS  Every column of a recording or rendered file by its quantity (t, x, fx, ...), in SI units, each N x 1.
%   READ_RECORDING and READ_RENDERED put them together. For MATLAB and GNU Octave.
if ~isfile(file)
  error('touchstone:file', '%s: there is no such file', file);
end
[~, ~, extension] = fileparts(file);
switch lower(extension)
  case {'.h5', '.hdf5'}
    [names, values] = read_hdf5(file);
  case '.gz'
    folder = tempname();
    mkdir(folder);
    cleaner = onCleanup(@() rmdir(folder, 's'));
    % A copy: gunzip of Octave removes what it unpacks.
    [~, name] = fileparts(file);
    copyfile(file, fullfile(folder, [name '.gz']));
    gunzip(fullfile(folder, [name '.gz']), folder);
    [names, values] = read_csv(fullfile(folder, name));
  otherwise
    [names, values] = read_csv(file);
end
columns = struct();
for i = 1:numel(names)
  cut = find(names{i} == '_', 1, 'last');
  if isempty(cut)
    columns.(names{i}) = values{i};
  else
    columns.(names{i}(1:cut - 1)) = to_si(values{i}, names{i}(cut + 1:end), file);
  end
end
end

function [names, values] = read_hdf5(file)
if exist('h5read', 'file') || exist('h5read', 'builtin')  % MATLAB
  about = h5info(file);
  names = {about.Datasets.Name};
  values = cellfun(@(name) double(h5read(file, ['/' name])), names, 'UniformOutput', false);
else  % Octave reads HDF5 itself
  loaded = load('-hdf5', file);
  names = fieldnames(loaded);
  values = cellfun(@(name) double(loaded.(name)), names, 'UniformOutput', false);
end
values = cellfun(@(column) column(:), values, 'UniformOutput', false);
end

function [names, values] = read_csv(file)
handle = fopen(file, 'r');
header = fgetl(handle);
fclose(handle);
header = strrep(strrep(strtrim(header), char([239 187 191]), ''), '"', '');
names = strtrim(strsplit(header, {',', ';', sprintf('\t')}));
delimiter = ',';
if any(header == ';')
  delimiter = ';';
elseif any(header == sprintf('\t'))
  delimiter = '\t';
end
table = dlmread(file, delimiter, 1, 0);
if size(table, 2) ~= numel(names)
  error('touchstone:columns', '%s: the first line names %d columns, but lines hold %d values', file, numel(names), size(table, 2));
end
values = num2cell(table, 1);
end

function values = to_si(values, unit, file)
% Dividing by a whole number rounds once; multiplying by 0.001 would round twice.
switch unit
  case {'s', 'm', 'N', 'Nm'}
  case {'ms', 'mm', 'mN', 'mNm', 'Nmm'}
    values = values / 1000;
  case {'us', 'um'}
    values = values / 1e6;
  case 'cm'
    values = values / 100;
  case {'km', 'kN'}
    values = values * 1000;
  otherwise
    error('touchstone:unit', '%s: the unit %s is not known; touchstone convert writes the file in SI units', file, unit);
end
end

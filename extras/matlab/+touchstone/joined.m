function matrix = joined(columns, quantities, file)
%JOINED  Columns of READ_COLUMNS beside each other, N x numel(quantities). `file` is for the message where one is missing.
matrix = [];
for i = 1:numel(quantities)
  if ~isfield(columns, quantities{i})
    error('touchstone:columns', '%s: the column %s is missing; the file has %s', file, quantities{i}, strjoin(fieldnames(columns)', ', '));
  end
  matrix = [matrix, columns.(quantities{i})]; %#ok<AGROW>
end
end

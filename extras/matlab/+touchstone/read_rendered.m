function rendered = read_rendered(file)
%READ_RENDERED  What a renderer answered (CSV, also .gz, or HDF5) in SI units.
%   rendered = touchstone.read_rendered('rendered.csv') has the fields
%     time_s      N x 1   time [s]
%     position_m  N x 3   tip of the probe, in the object's frame [m]
%     force_N     N x 3   force on the probe by the object [N]
%     contact_m   N x 3   surface contact point [m]; the tip itself when free
%     contact     N x 1   logical, true in contact
%     step_us     N x 1   time that each step took [us]; only where steps were timed
%   For MATLAB and GNU Octave.
columns = touchstone.read_columns(file);
rendered.time_s = touchstone.joined(columns, {'t'}, file);
rendered.position_m = touchstone.joined(columns, {'x', 'y', 'z'}, file);
rendered.force_N = touchstone.joined(columns, {'fx', 'fy', 'fz'}, file);
rendered.contact_m = touchstone.joined(columns, {'px', 'py', 'pz'}, file);
rendered.contact = touchstone.joined(columns, {'contact'}, file) ~= 0;
if isfield(columns, 'cost')
  rendered.step_us = columns.cost * 1e6;
end
end

function recording = read_recording(file)
%READ_RECORDING  A recording of Touchstone (CSV, also .gz, or HDF5) in SI units.
%   recording = touchstone.read_recording('press.h5') has the fields
%     time_s            N x 1   time [s]
%     position_m        N x 3   tip of the probe, in the object's frame [m]
%     force_N           N x 3   force on the probe by the object [N]
%     torque_Nm         N x 3   torque about the tip [Nm]; only where it was recorded
%     orientation_wxyz  N x 4   unit quaternions, sensor's frame to object's; only where they were recorded
%   Values in other units in the file (x_mm, fx_mN) are converted. For MATLAB and GNU Octave.
columns = touchstone.read_columns(file);
recording.time_s = touchstone.joined(columns, {'t'}, file);
recording.position_m = touchstone.joined(columns, {'x', 'y', 'z'}, file);
recording.force_N = touchstone.joined(columns, {'fx', 'fy', 'fz'}, file);
if isfield(columns, 'tx')
  recording.torque_Nm = touchstone.joined(columns, {'tx', 'ty', 'tz'}, file);
end
if isfield(columns, 'qw')
  recording.orientation_wxyz = touchstone.joined(columns, {'qw', 'qx', 'qy', 'qz'}, file);
end
end

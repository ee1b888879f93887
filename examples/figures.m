% Figs. 1 to 4 of A. P. Penner, Stick-slip behavior of paper during friction testing (1995), from records.
%
%   octave-cli --norc figures.m FOLDER OUTPUT
%
% Records made by make_records.sh; OUTPUT/figure-1-octave.svg ... are written. GNU Octave reads the numbers of a
% record alone, so what it must know of the tester stands here.
1;
warning('off', 'all');  % gnuplot draws without a display; Octave calls that discouraged.
graphics_toolkit('gnuplot');

global folder output
arguments = argv();
folder = arguments{1};
output = arguments{2};
if (! isfolder(output)) mkdir(output); end

% of the shipped scenes
global speeds weight stiffness
speeds = [3 6 12];                                   % in/min
weight = 2.331 * 9.80665;                            % N
omega0 = 2 * pi * 20 * sqrt(1 + 0.022 ^ 2);          % rad/s, undamped: 20 Hz is the damped one
stiffness = 2.331 * omega0 ^ 2;                      % N/m

function numbers = read_record(file)
  numbers = load(file, 'numbers').numbers;
end

function files = files_of(paper, speed)
  global folder
  found = dir(fullfile(folder, sprintf('%s-%d-*.h5', paper, speed)));
  files = arrayfun(@(one) fullfile(folder, one.name), found, 'UniformOutput', false);
end

function save_figure(f, number)
  global output
  print(f, fullfile(output, sprintf('figure-%d-octave.svg', number)), '-dsvg', '-S640,420');
  close(f);
end

function figure_1()
  global speeds
  f = figure('visible', 'off');
  hold on;
  papers = {'thorold', 'baie-comeau'};
  names = {'static_coefficient', 'kinetic_coefficient'};
  styles = {'o-', 'o--'; 's-', 's--'};
  labels = {};
  for p = 1:2
    for n = 1:2
      values = zeros(1, 3);
      for s = 1:3
        some = cellfun(@(file) read_record(file).results.(names{n}), files_of(papers{p}, speeds(s)));
        values(s) = mean(some);
      end
      plot(speeds, values, styles{p, n});
      labels{end + 1} = [papers{p} ', ' strtok(names{n}, '_')];
    end
  end
  xlabel('sled speed (in/min)'); ylabel('coefficient'); xlim([0 13]);
  legend(labels, 'location', 'east');
  title('Fig. 1: coefficient of friction against sled speed');
  save_figure(f, 1);
end

function signals(number, paper)
  global weight
  f = figure('visible', 'off');
  files = files_of(paper, 12);
  count = min(3, numel(files));
  for i = 1:count
    raw = read_record(files{i}).raw;
    subplot(count, 1, i);
    plot(raw.time, raw.force / weight);
    xlim([0.4 2.0]); ylim([0 0.42]);
    if (i == 1) title(sprintf('Fig. %d: %s at 12 in/min', number, paper)); end
  end
  xlabel('time (s)');
  save_figure(f, number);
end

function figure_4()
  global speeds stiffness
  f = figure('visible', 'off');
  for s = 1:3
    numbers = read_record(files_of('thorold', speeds(s)){1});
    velocity = gradient(double(numbers.raw.force), numbers.raw.time(2)) / stiffness;
    start = numbers.cycles.peak_time(1);
    subplot(3, 1, s);
    plot(numbers.raw.time, 1000 * velocity);
    xlim([start - 0.05, start + 0.35]);
    ylabel(sprintf('%d in/min', speeds(s)));
    if (s == 1) title('Fig. 4: one Thorold sample at each speed'); end
  end
  xlabel('time (s); speed of the coupling in mm/s');
  save_figure(f, 4);
end

figure_1();
signals(2, 'thorold');
signals(3, 'baie-comeau');
figure_4();

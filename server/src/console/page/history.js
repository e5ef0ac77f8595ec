// What is known of a stream's last seconds, in memory that does not grow: columns of numbers, used round and round.

/** One column is this long: the window at the most points that a server is asked for, and some to spare. */
const ROOM = 16384;

export class History {
  /** `names` of columns, besides time. */
  constructor(names) {
    this.columns = Object.fromEntries(["time", ...names].map((name) => [name, new Float64Array(ROOM)]));
    /** How many rows ever came; row number i is in place i % ROOM. */
    this.count = 0;
  }
  get length() { return Math.min(this.count, ROOM); }
  get oldest() { return this.count - this.length; }
  at(name, row) { return this.columns[name][row % ROOM]; }
  last(name) { return this.at(name, this.count - 1); }

  /** Takes a row: its time, and a number for each column; NaN where it is not known. */
  push(time, values) {
    const place = this.count++ % ROOM;
    this.columns.time[place] = time;
    for (const name in values) this.columns[name][place] = values[name];
  }

  /** The first row at `time` or after it; times grow. */
  find(time) {
    let [low, high] = [this.oldest, this.count];
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (this.at("time", middle) < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /**
   * The curve of a column from `from` to `to` [s] as points, of which each of `columns` pixels has two at most: the least and the
   * greatest, so that no peak is lost. Rows that are not known are left out.
   */
  curve(name, from, to, columns, scale = 1) {
    const points = [], times = this.columns.time, values = this.columns[name], begin = Math.max(this.find(from) - 1, this.oldest), end = this.find(to);
    const wide = (to - from) / columns || 1;
    let pixel = NaN, least = -1, most = -1;
    const close = () => {
      if (least < 0) return;
      const [first, second] = least < most ? [least, most] : [most, least];
      points.push([times[first % ROOM], values[first % ROOM] * scale]);
      if (second !== first) points.push([times[second % ROOM], values[second % ROOM] * scale]);
    };
    for (let row = begin; row < end; row++) {
      const value = values[row % ROOM];
      if (value !== value) continue;
      const here = Math.floor(times[row % ROOM] / wide);
      if (here !== pixel) {
        close();
        [pixel, least, most] = [here, row, row];
      } else if (value < values[least % ROOM]) least = row;
      else if (value > values[most % ROOM]) most = row;
    }
    close();
    return points;
  }
}

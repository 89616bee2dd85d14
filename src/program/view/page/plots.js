// Draws curves over time on a canvas: a title, a few marks, the curves, and the current time.

const kMargin = {left: 58, right: 10, top: 20, bottom: 16};

class Plot {
  // series: [{name, colour, values}]; log: the vertical axis is logarithmic; 0 is at its bottom.
  constructor(canvas, title, times, series, log, seek) {
    Object.assign(this, {canvas, title, times, series, log});
    this.range();
    const at = (e) => {
      const x = (e.offsetX - kMargin.left) / (canvas.clientWidth - kMargin.left - kMargin.right);
      seek(times[0] + Math.min(Math.max(x, 0), 1) * (times[times.length - 1] - times[0]));
    };
    canvas.addEventListener('pointerdown', at);
    canvas.addEventListener('pointermove', (e) => { if (e.buttons & 1) at(e); });
  }

  range() {
    const finite = [].concat(...this.series.map((s) => Array.from(s.values))).filter((y) => isFinite(y));
    if (this.log) {
      const positive = finite.filter((y) => y > 0);
      const most = positive.reduce((a, b) => Math.max(a, b), 1e-16);
      const least = Math.max(positive.reduce((a, b) => Math.min(a, b), most), 1e-6 * most);
      this.low = Math.floor(Math.log10(least));
      this.high = Math.max(Math.ceil(Math.log10(most)), this.low + 1);
    } else {
      this.low = finite.reduce((a, b) => Math.min(a, b), Infinity);
      this.high = finite.reduce((a, b) => Math.max(a, b), -Infinity);
      if (!(this.high > this.low)) [this.low, this.high] = [(this.low || 0) - 1, (this.high || 0) + 1];
    }
  }

  // Returns the values on the vertical axis that get a mark and a number.
  marks() {
    if (this.log) {
      const step = Math.max(1, Math.ceil((this.high - this.low) / 4)), marks = [];
      for (let k = this.low; k <= this.high; k += step) marks.push(k);
      return marks;
    }
    const step = roundUp((this.high - this.low) / 4), marks = [];
    for (let k = Math.ceil(this.low / step); k * step <= this.high; ++k) marks.push(k * step);
    return marks;
  }

  draw(now) {
    const {canvas, times} = this, ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const g = canvas.getContext('2d');
    g.scale(ratio, ratio);
    const {left, right, top, bottom} = kMargin, first = times[0], last = times[times.length - 1];
    const x = (t) => left + (width - left - right) * (t - first) / (last - first);
    const y = (v) => height - bottom - (height - top - bottom) * (v - this.low) / (this.high - this.low);
    g.font = '11px system-ui, "DejaVu Sans", sans-serif';
    this.drawMarks(g, width, height, y, first, last);
    this.drawTitle(g, left);
    for (const {colour, values} of this.series) {
      g.strokeStyle = colour;
      g.lineWidth = 1.6;
      g.beginPath();
      let drawing = false;
      values.forEach((v, k) => {
        const value = this.log ? Math.max(Math.log10(v), this.low) : v;
        if (!isFinite(value)) { drawing = false; return; }
        drawing ? g.lineTo(x(times[k]), y(value)) : g.moveTo(x(times[k]), y(value));
        drawing = true;
      });
      g.stroke();
    }
    g.strokeStyle = '#22303c';
    g.lineWidth = 1;
    g.strokeRect(x(now), top - 2, 0, height - top - bottom + 4);
  }

  drawMarks(g, width, height, y, first, last) {
    g.strokeStyle = '#e1e7ec';
    g.fillStyle = '#52616d';
    g.textAlign = 'right';
    g.lineWidth = 1;
    for (const mark of this.marks()) {
      g.strokeRect(kMargin.left, y(mark), width - kMargin.left - kMargin.right, 0);
      g.fillText(this.log ? '1e' + mark : show(mark), kMargin.left - 6, y(mark) + 4);
    }
    g.fillText(show(last) + ' s', width - kMargin.right, height - 3);
    g.textAlign = 'left';
    g.fillText(show(first), kMargin.left, height - 3);
  }

  drawTitle(g, left) {
    let at = left;
    const write = (text, colour) => {
      g.fillStyle = colour;
      g.fillText(text, at, 12);
      at += g.measureText(text).width + 10;
    };
    write(this.title, '#22303c');
    for (const {name, colour} of this.series) write(name, colour);
  }
}

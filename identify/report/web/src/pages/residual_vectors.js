import { choice, el, fixed, note } from '../dom.js';
import { addPlot, colorBar, column, commonLayout, norm, plain, sceneHeight, segments, sizeShades } from '../plot.js';
import { color } from '../theme.js';

class VectorView {
  constructor(data) {
    this.data = data;
    this.form = data.means.length > 0 ? 'means' : 'single';
    this.models = data.two_models ? ['given', 'reached'] : ['given'];
  }

  list() { return this.data[this.form]; }
  vectors(model) { return this.list().map((item) => item[`${model}_um`]); }

  /** The same for both pictures, so that they can be compared; outliers do not set it. */
  largest() {
    const sizes = this.models.flatMap((model) => this.vectors(model).map(norm)).sort((a, b) => a - b);
    return sizes[Math.floor(0.98 * (sizes.length - 1))] || 1e-9;
  }

  magnification() {
    const points = this.list().map((item) => item.point_mm);
    const extent = Math.max(...[0, 1, 2].map((i) => Math.max(...column(points, i)) - Math.min(...column(points, i))), 1);
    return (0.16 * extent) / (1e-3 * this.largest());
  }
}

function traces(view, model) {
  const list = view.list();
  const vectors = view.vectors(model);
  const factor = 1e-3 * view.magnification();
  const tips = list.map((item, k) => item.point_mm.map((p, i) => p + factor * vectors[k][i]));
  const size = vectors.map(norm);
  const scale = sizeShades(view.largest());
  const text = list.map((item, k) => `at ${item.point_mm.map((v) => fixed(v, 0)).join(', ')} mm<br>${vectors[k].map((v, i) => `${'XYZ'[i]} ${fixed(v, 2)}`).join(', ')} µm, size ${fixed(size[k], 2)} µm<br>${item.readings ? `${item.readings} readings, u ${fixed(item.u_um, 2)} µm` : plain(item.setup)}`);
  return [
    { ...segments(list.map((item, k) => [item.point_mm, tips[k]])), type: 'scatter3d', mode: 'lines', line: { width: 5, color: size.flatMap((s) => [s, s, s]), ...scale }, hoverinfo: 'skip', showlegend: false },
    {
      x: column(tips, 0), y: column(tips, 1), z: column(tips, 2), text, type: 'scatter3d', mode: 'markers', showlegend: false, hovertemplate: '%{text}<extra></extra>',
      marker: { size: 2.4, color: size, ...scale, colorbar: colorBar('|residual| [µm]', 0.9) },
    },
  ];
}

function layout(view, height) {
  const points = view.list().map((item) => item.point_mm);
  const axis = (i) => {
    const values = column(points, i);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const edge = 0.12 * (high - low) + 1;
    return {
      title: { text: `${'xyz'[i]} [mm]`, font: { size: 11, color: color(`axis-${'XYZ'[i]}`) } }, range: [low - edge, high + edge], backgroundcolor: 'rgba(0,0,0,0)', showline: true, linecolor: color('rule'), gridcolor: color('grid'), color: color('muted'),
      zerolinecolor: color('grid'), tickfont: { size: 10 }, showspikes: false, nticks: 5,
    };
  };
  return {
    height, margin: { l: 0, r: 0, t: 0, b: 0 }, paper_bgcolor: 'rgba(0,0,0,0)', ...commonLayout(), showlegend: false,
    scene: { xaxis: axis(0), yaxis: axis(1), zaxis: axis(2), aspectmode: 'data', camera: { eye: { x: 1.66, y: -1.88, z: 1.02 }, center: { x: 0, y: -0.04, z: -0.08 } }, domain: { x: [0, 0.9] } },
  };
}

const rms = (vectors) => Math.sqrt(vectors.reduce((sum, v) => sum + norm(v) ** 2, 0) / Math.max(1, vectors.length));

export function renderResidualVectors(body, data) {
  if (data.means.length + data.single.length === 0) {
    body.append(note('No reading is sensitive to a displacement of the functional point.'));
    return;
  }
  const view = new VectorView(data);
  const captions = view.models.map(() => el('figcaption'));
  const scale = el('span', { class: 'muted' });
  const describe = () => {
    view.models.forEach((model, k) => captions[k].replaceChildren(el('strong', {}, model === 'given' ? 'Given model: ' : 'Model reached: '), `RMS ${fixed(rms(view.vectors(model)), 2)} µm`));
    scale.textContent = `magnified ${Number(view.magnification().toPrecision(2)).toLocaleString('en-US')} ×`;
  };
  const redraws = [];
  const controls = el('div', { class: 'controls' });
  if (data.means.length > 0 && data.single.length > 0) {
    controls.append(choice('Vectors', [['means', 'means of neighbouring readings'], ['single', 'single readings']], (value) => {
      view.form = value;
      describe();
      redraws.forEach((again) => again());
    }));
  }
  controls.append(scale);
  const nodes = view.models.map(() => el('div', { class: 'plot scene' }));
  describe();
  body.append(
    note('Displacement of the functional point that the residuals ask for, from the nominal point to the magnified dot; workpiece coordinates. Means: least squares over the readings of a cell of the measured volume, directions to which they are hardly sensitive left at zero; u is what noise puts into one. Single readings: along what each of them feels.'),
    controls,
    el('div', { class: nodes.length > 1 ? 'scenes' : '' }, nodes.map((node, k) => el('figure', {}, [captions[k], node]))),
  );
  nodes.forEach((node, k) => redraws.push(addPlot(node, () => ({ data: traces(view, view.models[k]), layout: layout(view, sceneHeight(node)) }))));
}

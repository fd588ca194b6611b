// A lens with its menus.
import { useEffect, useRef, useState } from 'preact/hooks';
import { call } from '../api/call.js';
import { report } from '../app/actions.js';
import { ensure } from '../app/columns.js';
import { change, close } from '../app/pictures.js';
import { beforeModel, campaign, currentModel, state, variables } from '../app/store.js';
import { directionsOf } from '../data/variables.js';
import { begin } from '../draw/timing.js';
import { Picture } from './picture.js';
import { circlesOf } from './polar.js';
import { lenses } from './registry.js';
import { hasRotaryAxes, layerOptions, lineOptions, motionOptions, toolOptions } from './rotary.js';
import { kOf } from './values.js';

/** A map is timed apart from the other pictures. */
function beginChange() {
  begin('variable');
  begin('map');
}

function Menu({ label, name, value, options, onChoose }) {
  return (
    <label class="menu">{label && <span>{label}</span>}
      <select value={value} aria-label={name} onChange={(event) => { beginChange(); onChoose(event.currentTarget.value); }}>
        {options.map(([name, words]) => <option key={name} value={name}>{words}</option>)}
      </select>
    </label>
  );
}

const positions = () => variables.value.filter(({ kind, name }) => kind === 'position' || kind === 'point' || ['x', 'y', 'z'].includes(name));
const variableOptions = (list) => list.map(({ name, label }) => [name, label]);

/** A menu of what the program's answer offers; nothing to choose of one. */
function Chosen({ name, at, of, config, set }) {
  const options = of(config);
  return options.length > 1 && <Menu label="" name={name} value={config[at] ?? options[0][0]} options={options} onChoose={(value) => set({ [at]: value })} />;
}

const controls = {
  x: ({ config, set, lens }) => <Menu name="Variable" label="" value={config.x} options={variableOptions(lens.positionsOnly ? positions() : variables.value)} onChoose={(x) => set({ x, period: 0 })} />,
  y: ({ config, set }) => <Menu label="and" value={config.y} options={variableOptions(variables.value)} onChoose={(y) => set({ y })} />,
  of: ({ config, set }) => <Menu label="of" value={config.of} options={kOf} onChoose={(of) => set({ of })} />,
  when: ({ config, set }) => beforeModel.value && <Menu label="" name="Model" value={config.when ?? 'now'} options={[['now', 'now'], ['before', 'before']]} onChoose={(when) => set({ when })} />,
  split: ({ config, set }) => <Menu label="split by" value={config.split ?? ''} options={[['', 'nothing'], ...variableOptions(directionsOf(variables.value))]} onChoose={(split) => set({ split })} />,
  what: ({ config, set }) => <Menu label="of" value={config.what ?? 'residual'} options={[['residual', 'what remains'], ['readings', 'measured and predicted']]} onChoose={(what) => set({ what })} />,
  circle: ({ config, set }) => <Menu label="" name="Circle" value={config.circle ?? circlesOf(campaign.value.setups)[0]?.index} options={circlesOf(campaign.value.setups).map(({ index, name }) => [index, name])} onChoose={(circle) => set({ circle })} />,
  perSigma: ({ config, set }) => (
    <label class="menu"><input type="checkbox" checked={config.perSigma} onChange={(event) => { beginChange(); set({ perSigma: event.currentTarget.checked }); }} /><span title="The uncertainty that the campaign states, not the estimated noise: what the noise has swallowed stays visible">÷ stated σ</span></label>
  ),
  period: ({ config, set }) => (
    <label class="menu"><span>period</span><input type="number" min="0" step="any" value={config.period || (config.spectrum?.peak ?? '')} onChange={(event) => set({ period: Number(event.currentTarget.value) })} /></label>
  ),
  motion: ({ config, set }) => <Chosen name="Error motion" at="motion" of={motionOptions} config={config} set={set} />,
  line: ({ config, set }) => <Chosen name="Axis" at="line" of={lineOptions} config={config} set={set} />,
  layer: ({ config, set }) => <Chosen name="Error" at="layer" of={layerOptions} config={config} set={set} />,
  tool: ({ config, set }) => <Chosen name="Tool" at="tool" of={toolOptions} config={config} set={set} />,
  turn: ({ config, set }) => (
    <span class="turns" role="group" aria-label="Turn the picture">
      {[['⟲', 'left', -0.2, 0], ['⟳', 'right', 0.2, 0], ['▴', 'up', 0, -0.15], ['▾', 'down', 0, 0.15]].map(([sign, words, turn, tilt]) => (
        <button key={words} type="button" aria-label={`Turn ${words}`} onClick={() => set({ turn: (config.turn ?? -0.6) + turn, tilt: Math.max(-1.5, Math.min(1.5, (config.tilt ?? 0.45) + tilt)) })}>{sign}</button>
      ))}
    </span>
  ),
};

/** What a lens asks the program for, besides columns. */
const answers = {
  periodogram: async ({ x }) => ({ spectrum: await call('periodogram', { variable: x }).catch((error) => ({ period: [], power: [], problem: error.message })) }),
  rotary: async () => ({ rotary: (await call('rotary', {})).rotary }),
  polar: async () => ({ circles: (await call('polar', {})).circles }),
};

function useAnswers(lens, config) {
  const [got, setGot] = useState({});
  const model = currentModel.value;
  useEffect(() => {
    if (!lens.asks || !model) return undefined;
    let here = true;
    answers[lens.asks](config).then((answer) => { if (here) setGot(answer); }).catch((error) => report(lens.asks, error));
    return () => { here = false; };
  }, [lens.asks, config.x, model?.number, model?.standing, state.value.revision]);
  return got;
}

/** The canvas layers, and the sentence below them. */
function Canvas({ config, onChange, label }) {
  const [frame, below, above, plot] = [useRef(), useRef(), useRef(), useRef()];
  const picture = useRef(null);
  const words = useRef();
  const said = useRef(null);
  const latest = useRef(onChange);
  latest.current = onChange;
  useEffect(() => {
    const onReadout = (sentence) => {
      if (sentence === said.current) return;
      said.current = sentence;
      words.current.textContent = sentence ?? '';
    };
    picture.current = new Picture({ frame: frame.current, below: below.current, above: above.current, plot: plot.current, onReadout, onChange: (values) => latest.current(values) });
    return () => picture.current.end();
  }, []);
  useEffect(() => picture.current.show(config), [config]);
  return (
    <>
      <div class="canvas" ref={frame}>
        <canvas ref={below} aria-hidden="true" />
        <div ref={plot} class="plotted" aria-hidden="true" />
        <canvas ref={above} class="above" tabindex="0" role="application" aria-roledescription="picture" aria-label={label} />
      </div>
      <p class="readout" ref={words} />
    </>
  );
}

const kHelp = 'Arrow keys move a window that marks readings, with Shift they change its size, Escape clears.';

export function Card({ config }) {
  const lens = lenses[config.kind];
  const set = (values) => change(config.key, values);
  const adjusted = lens.adjust ? lens.adjust(config, variables.value) : config;
  const got = useAnswers(lens, adjusted);
  const whole = { ...adjusted, ...got };
  const signature = JSON.stringify(adjusted);
  const [shownConfig, setShown] = useState(whole);
  useEffect(() => { setShown(whole); }, [signature, got]);
  useEffect(() => { ensure(lens.needs(adjusted, variables.value)).catch((error) => report('columns', error)); }, [signature, campaign.value]);
  const offered = (each) => (each.kind !== 'polar' || circlesOf(campaign.value.setups).length > 0) && (!each.ofRotaryAxes || hasRotaryAxes(variables.value));
  const kinds = Object.values(lenses).filter(offered).map(({ kind, title }) => [kind, title]);
  return (
    <article class={`lens lens-${config.kind}`} aria-label={`Lens: ${lens.title}`}>
      <div class="lens-menus">
        <Menu label="" name="Kind of lens" value={config.kind} options={kinds} onChoose={(kind) => set({ kind })} />
        {lens.controls.map((name) => { const Control = controls[name]; return <Control key={name} config={whole} set={set} lens={lens} />; })}
        <button type="button" class="close" aria-label={`Close the lens: ${lens.title}`} onClick={() => close(config.key)}>×</button>
      </div>
      <Canvas config={shownConfig} onChange={set} label={`${lens.title}. ${kHelp}`} />
    </article>
  );
}

'use strict';
(() => {
  let update = null;
  // The frame's policy does not reach WebRTC. Its constructors go before a panel's code comes.
  for (const name of Object.getOwnPropertyNames(globalThis)) {
    if (/^(webkit)?RTC/.test(name)) delete globalThis[name];
  }

  const tell = (message) => parent.postMessage(message, '*');

  function fail(problem) {
    update = null;
    tell({ op: 'problem', text: String(problem?.message ?? problem) });
  }

  async function open(script) {
    const address = URL.createObjectURL(new Blob([script], { type: 'text/javascript' }));
    try {
      const panel = await import(address);
      if (typeof panel.default !== 'function') throw new TypeError('it exports no default function');
      update = await panel.default(document.body);
      if (typeof update !== 'function') throw new TypeError('its default function returns none to call with samples');
      tell({ op: 'opened', title: panel.title, topics: panel.topics });
    } catch (problem) {
      fail(problem);
    } finally {
      URL.revokeObjectURL(address);
    }
  }

  function show(samples) {
    if (update === null) return;
    try {
      update(samples);
    } catch (problem) {
      fail(problem);
    }
  }

  addEventListener('message', ({ source, data }) => {
    if (source !== parent) return;
    if (data.op === 'open') void open(data.script);
    else if (data.op === 'samples') show(data.samples);
    else if (data.op === 'theme') {
      for (const [name, value] of Object.entries(data.tokens)) document.documentElement.style.setProperty(name, value);
      document.documentElement.style.colorScheme = data.scheme;
    }
  });
  addEventListener('error', ({ message }) => fail(message));
  addEventListener('unhandledrejection', ({ reason }) => fail(reason));
  tell({ op: 'ready' });
})();

// Begins Foxglove Studio with the parts that a program around it brings: settings and layouts, in memory.
const settings = new Map([
  ['colorScheme', 'dark'],
  ['enableNewImagePanel', true],
  ['ui.open-dialog-startup', false],
  ['telemetry.telemetryEnabled', false],
])
const appConfiguration = {
  get: (key) => settings.get(key),
  set: async (key, value) => void settings.set(key, value),
  addChangeListener: () => {},
  removeChangeListener: () => {},
}

const layouts = new Map()
const layoutStorage = {
  list: async () => [...layouts.values()],
  get: async (_, id) => layouts.get(id),
  put: async (_, layout) => (layouts.set(layout.id, layout), layout),
  delete: async (_, id) => void layouts.delete(id),
  importLayouts: async () => {},
}

async function begin() {
  const address = new URLSearchParams(location.search).get('layout')
  const data = await (await fetch(address)).json()
  const savedAt = new Date().toISOString()
  layouts.set('shipped', {
    id: 'shipped',
    name: 'µ-CAT',
    permission: 'CREATOR_WRITE',
    baseline: { data, savedAt },
    working: undefined,
    syncInfo: undefined,
  })
  localStorage.setItem('studio.profile-data', JSON.stringify({ currentLayoutId: 'shipped' }))
  await initI18n()
  const dataSources = [new FoxgloveWebSocketDataSourceFactory(), new RosbridgeDataSourceFactory()]
  const app = React.createElement(App, {
    deepLinks: [location.href],
    appConfiguration,
    dataSources,
    layoutStorage,
    extensionLoaders: [],
    enableGlobalCss: true,
  })
  ReactDOM.render(app, document.getElementById('root'))
}

void begin()

// Styles first: what a component says of itself goes before what holds for all.
import './styles/tokens.css';
import './styles/base.css';
import './styles/listing.css';
import { mount } from 'svelte';
import App from './App.svelte';
import { LiveFeed } from './live/feed';
import { Router } from './router.svelte';
import { Theme } from './theme.svelte';

const place = document.getElementById('page');
if (place === null) throw new Error('index.html has no element "page"');
const protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
mount(App, {
  target: place,
  props: { feed: new LiveFeed(`${protocol}//${location.host}/api/live`), router: new Router(), theme: new Theme() },
});

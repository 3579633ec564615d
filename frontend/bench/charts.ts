import '../src/styles/tokens.css';
import '../src/styles/base.css';
import { mount } from 'svelte';
import { Theme } from '../src/theme.svelte';
import Charts from './Charts.svelte';
import { place, startFeed } from './feed';

mount(Charts, { target: place(), props: { live: startFeed().live, theme: new Theme() } });

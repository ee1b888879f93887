// Chromium by playwright-core, for the tests in Python: a command a line on standard input, {"do", "page", …}, and an
// answer a line on standard output, {"value"} or {"error"}. A page is known by the number that "open" gave.
//
// driver.mjs PLAYWRIGHT_CORE CHROMIUM SANDBOX PATIENCE_MS

import { createRequire } from 'node:module';
import path from 'node:path';
import readline from 'node:readline';

const [library, program, sandbox, patience] = process.argv.slice(2);
const { chromium } = createRequire(import.meta.url)(path.resolve(library));
const PATIENCE_MS = Number(patience);

const browser = await chromium.launch({
  executablePath: program,
  chromiumSandbox: sandbox === 'true',
  timeout: PATIENCE_MS,
  // Shared memory is scarce in containers. A page behind another would have no frames and slow timers.
  args: ['--disable-dev-shm-usage', '--hide-scrollbars', '--disable-backgrounding-occluded-windows',
    '--disable-renderer-backgrounding', '--disable-background-timer-throttling'],
});
const VIEWPORT = { width: 1280, height: 1600 };
const pages = [];
let downloadFolder = null;
const downloads = [];  // One promise for each, of the file.

/** What a page said and asked for, from its begin on. */
const heed = (page) => {
  const seen = { page, complaints: [], requests: [] };
  pages.push(seen);
  page.on('pageerror', (error) => seen.complaints.push(String(error)));
  page.on('console', (message) => {
    if (['error', 'warning', 'assert'].includes(message.type())) seen.complaints.push(message.text());
  });
  page.on('request', (request) => seen.requests.push(request.url()));
  page.on('download', (download) => {
    const file = path.join(downloadFolder, download.suggestedFilename());
    downloads.push(download.saveAs(file).then(() => file));
  });
};

/** Windows with a mouse, and those of a tablet, on which fingers point. */
const context = async (more) => {
  const made = await browser.newContext({ acceptDownloads: true, viewport: VIEWPORT, ...more });
  made.setDefaultTimeout(PATIENCE_MS);
  made.on('page', heed);
  return made;
};
const mouse = await context({});
const tablet = await context({ hasTouch: true, isMobile: true });

/** What is asked for again and again until it is there. */
const until = async (found) => {
  const end = Date.now() + PATIENCE_MS;
  while (Date.now() < end) {
    const value = await found();
    if (value) return value;
    await new Promise((done) => setTimeout(done, 20));
  }
  throw new Error(`not within ${PATIENCE_MS} ms`);
};

const element = (page, { selector, index }) => page.locator(selector).nth(index);

const commands = {
  async open(_, { address, dark, touch, before }) {
    const page = await (touch ? tablet : mouse).newPage();
    if (before) await page.addInitScript(before);
    await page.emulateMedia({ colorScheme: dark ? 'dark' : 'light' });
    await page.goto(address);
    return pages.findIndex((seen) => seen.page === page);
  },
  async opened(_, { ending }) {
    const found = await until(() => pages.find(({ page }) => !page.isClosed() && page.url().endsWith(ending)));
    await found.page.waitForLoadState();
    return pages.indexOf(found);
  },
  save_downloads: (_, { folder }) => { downloadFolder = folder; },
  async wait_for_download() {
    await until(() => downloads[0]);
    return downloads.shift();
  },
  close: ({ page }) => page.close(),
  /** As a hand closes a tab: the page hears of it. */
  leave: ({ page }) => page.close({ runBeforeUnload: true }),
  reload: ({ page }) => page.reload().then(() => null),
  value: ({ page }, { expression }) => page.evaluate(expression),
  // Not waitForFunction(), whose eval() the policy of the pages forbids.
  until: ({ page }, { condition }) => until(() => page.evaluate(`!!(${condition})`)),
  complaints: ({ complaints }) => complaints,
  requests: ({ requests }) => requests,
  click: ({ page }, command) => element(page, command).click({ clickCount: command.times }),
  async drag({ page }, command) {
    const area = element(page, command);
    await area.scrollIntoViewIfNeeded();
    const { x, y, width, height } = await area.boundingBox();
    const at = (part) => [x + part * width, y + height / 2];
    await page.mouse.move(...at(command.start));
    await page.mouse.down();
    await page.mouse.move(...at(command.end), { steps: 2 });
    await page.mouse.up();
  },
  /** Over a part of its width, half-way down; above 0 is down. */
  async wheel({ page }, command) {
    const area = element(page, command);
    await area.scrollIntoViewIfNeeded();
    const { x, y, width, height } = await area.boundingBox();
    await page.mouse.move(x + command.at * width, y + height / 2);
    await page.mouse.wheel(0, command.turn);
  },
  /** What lives after a collection of garbage: bytes of JavaScript, nodes and listeners of documents. */
  async living({ page }) {
    const session = await page.context().newCDPSession(page);
    try {
      await session.send('HeapProfiler.collectGarbage');
      const { usedSize: bytes } = await session.send('Runtime.getHeapUsage');
      const { nodes, jsEventListeners: listeners } = await session.send('Memory.getDOMCounters');
      return { bytes, nodes, listeners };
    } finally {
      await session.detach();
    }
  },
  press: ({ page }, { key }) => page.keyboard.press(key),
  type: ({ page }, { text }) => page.keyboard.insertText(text),
  resize: ({ page }, { width, height }) => page.setViewportSize({ width, height }),
  tap: ({ page }, command) => element(page, command).tap(),
  like: ({ page }, { dark }) => page.emulateMedia({ colorScheme: dark ? 'dark' : 'light' }),
  /** As for a printer, or as on a screen again. */
  print: ({ page }, { on }) => page.emulateMedia({ media: on ? 'print' : 'screen' }),
  pdf: ({ page }, { file }) => page.pdf({ path: file, format: 'A4', printBackground: false }).then(() => null),
  bring_to_front: ({ page }) => page.bringToFront(),
  screenshot: ({ page }, { file, height }) =>
    page.screenshot({ path: file, fullPage: true, ...(height && { clip: { x: 0, y: 0, width: page.viewportSize().width, height } }) }).then(() => null),
};

for await (const line of readline.createInterface({ input: process.stdin })) {
  const command = JSON.parse(line);
  let answer;
  try {
    answer = { value: (await commands[command.do](pages[command.page], command)) ?? null };
  } catch (error) {
    answer = { error: String(error) };
  }
  process.stdout.write(`${JSON.stringify(answer)}\n`);
}
await browser.close();
